// SPDX-License-Identifier: GPL-2.0-only
// A closed surface of triangles, which may have creases and holes: its flat sides, sharp edges and corners, smooth parts, and a
// tree of boxes that finds those near.

#pragma once

#include "geometry/box_tree.h"
#include "rigid/curved_triangle.h"
#include "rigid/polyhedron.h"

#include <array>
#include <vector>

namespace mdanim {

class TriangleMesh {
 public:
  using Corners = std::array<int, 3>;    // counter-clockwise from outside
  struct Triangle {
    Corners corner;
    Corners beyond;    // triangles beyond edge k, from corner k to the next one
    int side;
    CurvedTriangle patch;
  };
  // An edge of a side.
  struct MeshBorder {
    Vec3 from, along, outward;    // `along`, of length 1, with the side to its left; `outward` within the side, away from it
    double length;
    int beyond;    // the side there
    bool is_convex, is_sharp;
  };
  // Triangles in one plane that hang together. It need be neither convex nor without holes.
  struct MeshSide {
    Vec3 normal;
    double at = 0.0;    // normal . X of its points
    double area = 0.0;
    std::vector<int> triangles;
    std::vector<MeshBorder> borders;
  };
  // Where the projection of a point on a side is.
  struct Footprint {
    double inside;       // distance to the nearest border, negative outside
    double from_edge;    // the same of sharp convex borders; HUGE_VAL where there is none
    Vec3 inward;         // its gradient
  };

  // Throws std::runtime_error unless each edge has two triangles and each triangle an area.
  TriangleMesh(std::vector<Vec3> places, const std::vector<Corners> &triangles);
  template <class Turn> TriangleMesh moved(const Turn &turn) const
  {
    std::vector<Vec3> now;
    std::vector<Corners> corners;
    for (const Vec3 &at : places) now.push_back(turn(at));
    for (const Triangle &one : all_triangles) corners.push_back(one.corner);
    return TriangleMesh(std::move(now), corners);
  }

  const std::vector<Triangle> &triangles() const { return all_triangles; }
  const std::vector<MeshSide> &sides() const { return all_sides; }
  // Corners at which three edges or more meet, and convex edges.
  const std::vector<Polyhedron::Corner> &corners() const { return all_corners; }
  const std::vector<Polyhedron::Edge> &edges() const { return all_edges; }

  // Numbers of those whose boxes meet this one, ascending.
  std::vector<int> triangles_near(const Box &box) const { return near(tree, box); }
  std::vector<int> corners_near(const Box &box) const { return near(tree_of_corners, box); }
  std::vector<int> edges_near(const Box &box) const { return near(tree_of_edges, box); }

  // Triangles around corner k of a triangle, itself the first.
  std::vector<int> around(int triangle, int k) const;
  double depth(int side, const Vec3 &x) const { return all_sides[side].at - dot(all_sides[side].normal, x); }
  Footprint footprint(int side, const Vec3 &x) const;
  double distance(int triangle, const Vec3 &x) const { return all_triangles[triangle].patch.closest(x).distance; }
  double bound() const;    // largest distance from the origin

 private:
  static std::vector<int> near(const BoxTree &tree, const Box &box);
  void join(const std::vector<Corners> &corners);
  void find_sides();
  void take_into(int side, int seed, double near);
  void find_patches();
  template <class Passes> std::vector<int> around(int triangle, int k, const Passes &passes) const;
  Vec3 smooth_normal(int triangle, int corner) const;
  void find_borders();
  void find_trees();
  bool is_smooth(int triangle, int edge) const;
  const Vec3 &normal_of(int triangle) const { return all_sides[all_triangles[triangle].side].normal; }
  const Vec3 &place(int triangle, int k) const { return places[all_triangles[triangle].corner[k % 3]]; }

  std::vector<Vec3> places;
  std::vector<Triangle> all_triangles;
  std::vector<double> areas;
  std::vector<MeshSide> all_sides;
  std::vector<Polyhedron::Corner> all_corners;
  std::vector<Polyhedron::Edge> all_edges;
  BoxTree tree, tree_of_corners, tree_of_edges;
};

}    // namespace mdanim
