// SPDX-License-Identifier: GPL-2.0-only
// A convex polyhedron by its corners, edges and faces.

#pragma once

#include "numbers/vec3.h"

#include <vector>

namespace mdanim {

class Polyhedron {
 public:
  struct Corner {
    Vec3 at;
    std::vector<Vec3> ways;    // along its edges, and between two of a face that are nearly in line, away from it; of length 1
    std::vector<int> faces;    // those that meet there
    bool covered = false;
  };
  struct Edge {
    Vec3 middle, along;    // `along` has length 1
    double half;           // of its length
    Vec3 across[2];        // within its faces, away from the edge; of length 1
    int faces[2];
    bool covered = false;
  };
  // An edge of a face as it leads away from a corner: `into` leads from it into the face.
  struct EdgeEnd {
    int corner, face;
    Vec3 way, into;
  };
  // A sharp edge of a face: the face ends where outward . X = at.
  struct Bound {
    Vec3 outward;
    double at;
    int outline = 0;    // bounds that turn little from one to the next are one curve
  };
  struct Face {
    Vec3 normal;                  // outward, of length 1
    double at;                    // normal . X of its points
    std::vector<int> corners;     // around it, counter-clockwise from outside
    std::vector<Bound> bounds;    // those of one outline follow each other
    std::vector<int> next;        // faces beyond its blunt edges
    bool covered = false;         // another body is flush there: neither the face nor its edges and corners touch anything
  };
  // The closest point of the surface: its normal, and the distance, negative inside.
  struct Foot {
    Vec3 normal;
    double distance;
  };

  Polyhedron() = default;
  // Each face is a list of corners, counter-clockwise from outside. Throws std::runtime_error unless they close a convex body.
  Polyhedron(const std::vector<Vec3> &corners, const std::vector<std::vector<int>> &faces);
  static Polyhedron box(const Vec3 &half);

  void cover(int face);
  // Covers faces anew: those with 1, of which others are behind, are closed, and so are edges and corners of theirs that no face
  // with 2 has, which is open again. The other faces have 0.
  void cover(const std::vector<char> &faces);

  const std::vector<Corner> &corners() const { return all_corners; }
  const std::vector<Edge> &edges() const { return all_edges; }
  const std::vector<Face> &faces() const { return all_faces; }
  // Directions of edges, each once but for its sign.
  const std::vector<Vec3> &directions() const { return all_directions; }

  // Where edges of a face are nearly in line at a corner, the body is between them: adds that way.
  static void add_ways_between(std::vector<Corner> &corners, std::vector<EdgeEnd> ends);

  double area(int face) const;
  // Largest normal . X - at over faces: below 0 inside, at most the distance outside.
  double outside(const Vec3 &x) const;
  // Largest n . X.
  double reach(const Vec3 &n) const;
  Foot nearest(const Vec3 &x) const;
  double thickness() const;    // least, from a face to the farthest corner
  // The same body with all points p -> turn(p): `turn` must keep lengths and orientation.
  template <class Turn> Polyhedron moved(const Turn &turn) const
  {
    std::vector<Vec3> places;
    std::vector<std::vector<int>> loops;
    for (const Corner &corner : all_corners) places.push_back(turn(corner.at));
    for (const Face &face : all_faces) loops.push_back(face.corners);
    Polyhedron found(places, loops);
    for (std::size_t f = 0; f < all_faces.size(); ++f)
      if (all_faces[f].covered) found.cover(static_cast<int>(f));
    return found;
  }

 private:
  double size() const;
  void check_corners() const;
  void find_faces(const std::vector<std::vector<int>> &loops);
  void find_edges();
  static void find_outlines(std::vector<Bound> &bounds);

  std::vector<Corner> all_corners;
  std::vector<Edge> all_edges;
  std::vector<Face> all_faces;
  std::vector<Vec3> all_directions;
};

}    // namespace mdanim
