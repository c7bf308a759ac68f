// SPDX-License-Identifier: GPL-2.0-only
// Shapes of rigid bodies, as contact sees them.

#pragma once

#include "numbers/vec3.h"
#include "rigid/body.h"
#include "rigid/curve.h"
#include "rigid/polyhedron.h"
#include "rigid/triangle_mesh.h"

#include <functional>
#include <map>
#include <memory>
#include <vector>

namespace mdanim {

// Where a shape is: p -> place + turn p.
struct Pose {
  Vec3 place;
  Quaternion q;
};

// A pose in space in the frame of a body, to 2^-42 of a size and of a turn: so bodies alike have their shapes at one place to the
// bit.
Pose in_body(const Pose &pose, const RigidBody &body, double size);

class SolidShape {
 public:
  enum ShapeKind { POLYHEDRON, BALL, CYLINDER, CONE, ELLIPSOID, TORUS, MESH };

  static SolidShape of(Polyhedron polyhedron);
  static SolidShape ball(double radius);
  // About the third axis, from -height/2 to height/2; a cone has its tip at height/2.
  static SolidShape cylinder(double radius, double height);
  static SolidShape cone(double radius, double height);
  static SolidShape ellipsoid(const Vec3 &half_axes);
  // A ring about the third axis: radius of its middle line, and of its tube, the smaller one.
  static SolidShape torus(double radius, double tube);
  // A closed surface, with the thickness of its thinnest part.
  static SolidShape of(TriangleMesh mesh, double thin);

  // Whether both have the same bits.
  bool is_same(const SolidShape &other) const;
  // Covers faces of a polyhedron anew (see there).
  void cover(const std::vector<char> &faces);
  // The same shape in the frame of its body.
  SolidShape placed(const Pose &pose) const;

  ShapeKind kind() const { return its_kind; }
  const char *name() const;
  const Polyhedron &polyhedron() const { return *its_polyhedron; }
  const TriangleMesh &mesh() const { return *its_mesh; }
  const Vec3 &middle() const { return its_middle; }
  const Vec3 &axis(int k) const { return axes[k]; }
  double radius() const { return size.x; }
  double half_height() const { return size.z; }
  double tube() const { return size.y; }    // of a torus
  const Vec3 &half_axes() const { return size; }
  double bound() const { return its_bound; }    // largest distance from the origin
  double thin() const { return its_thin; }      // thinnest part

  // Corners, and the tip of a cone.
  const std::vector<Polyhedron::Corner> &corners() const
  { return its_kind == CONE ? its_tip : its_kind == MESH ? its_mesh->corners() : its_polyhedron->corners(); }
  // Straight sharp edges that are convex.
  const std::vector<Polyhedron::Edge> &edges() const { return its_kind == MESH ? its_mesh->edges() : its_polyhedron->edges(); }
  // Flat sides of what has corners, and sides of what is round.
  std::size_t sides() const
  {
    return its_kind == MESH         ? its_mesh->sides().size()
           : its_kind == POLYHEDRON ? its_polyhedron->faces().size()
                                    : its_curves.size();
  }
  // Edges, rims, and curves with a radius: the axes of cylinders and cones, the middle line of a torus.
  const std::vector<Curve> &curves() const { return its_curves; }

  // The closest point of the surface to x in the frame of the body: its normal, and the distance, negative inside. Not of a mesh.
  Polyhedron::Foot nearest(const Vec3 &x) const;
  // Calls visit(place, normal) for features of the surface that other bodies touch first: corners with their faces, ends of axes.
  void each_feature(const std::function<void(const Vec3 &, const Vec3 &)> &visit) const;

 private:
  static const std::shared_ptr<const Polyhedron> &none();
  Polyhedron::Foot nearest_of_revolution(const Vec3 &from_middle) const;
  Polyhedron::Foot nearest_of_ellipsoid(const Vec3 &from_middle) const;
  void each_feature_of_torus(const std::function<void(const Vec3 &, const Vec3 &)> &visit) const;
  void find_curves();

  ShapeKind its_kind = BALL;
  std::shared_ptr<const Polyhedron> its_polyhedron = none();
  std::shared_ptr<const TriangleMesh> its_mesh;
  Vec3 its_middle, axes[3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  Vec3 size;    // radius and half of the height, half axes, or the radii of a torus
  std::vector<Polyhedron::Corner> its_tip;
  std::vector<Curve> its_curves;
  double its_bound = 0.0, its_thin = 0.0;
};

// Shapes of bodies: those with the same bits are shared.
class SharedShapes {
 public:
  const SolidShape &take(SolidShape shape);

 private:
  std::multimap<double, SolidShape> known;    // by their bounds
};

}    // namespace mdanim
