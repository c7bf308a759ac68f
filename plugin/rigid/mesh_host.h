// SPDX-License-Identifier: GPL-2.0-only
// A surface of triangles as host of corners and rims, in its own frame. It may be concave: a corner may be below several sides.

#pragma once

#include "rigid/touch_corners.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace mdanim {

class MeshHost {
 public:
  // `near`: numbers of the sides that may be touched.
  MeshHost(const TriangleMesh &mesh, double ramp, const std::vector<int> &near) : mesh(mesh), ramp(ramp), near(near) {}

  template <class Visit> void each_flat_side(const Visit &visit) const
  {
    for (const int side : near) visit(side);
  }
  const Vec3 &normal(int side, const Vec3 &) const { return mesh.sides()[side].normal; }
  double depth(int side, const Vec3 &x) const { return mesh.depth(side, x); }
  static double outside(const Vec3 &) { return -HUGE_VAL; }
  // It fades over the ramp at sharp edges that are convex.
  double part(int side, const Vec3 &x, Vec3 &slope) const
  {
    slope = Vec3();
    const TriangleMesh::Footprint foot = mesh.footprint(side, x);
    if (foot.from_edge == HUGE_VAL) return 1.0;
    double steep;
    const double part = smooth_step(foot.from_edge, ramp, steep);
    slope = steep * foot.inward;
    return part;
  }
  // The side to which x belongs, from this one over blunt edges: both planes at an edge are as deep on the plane between them.
  int shallowest(int side, const Vec3 &x) const
  {
    for (int moves = 0; moves < MOST_MOVES; ++moves) {
      int found = side;
      double most = 0.0;
      const double own = depth(side, x);
      for (const TriangleMesh::MeshBorder &border : mesh.sides()[side].borders) {
        if (border.is_sharp) continue;
        const double more = (border.is_convex ? 1.0 : -1.0) * (own - depth(border.beyond, x));
        if (more > most) most = more, found = border.beyond;
      }
      if (found == side) break;
      side = found;
    }
    return side;
  }
  // Whether a corner that is below a side begins to touch it there. Sides beyond convex edges near it must be above it by less,
  // unless the corner leads into the host through them.
  template <class Turn>
  bool is_below(int side, const Polyhedron::Corner &corner, const Turn &in_owner, const Vec3 &x, double deepest) const
  {
    const double own = depth(side, x);
    if (own <= 0.0 || own > deepest || leads_in(side, corner, in_owner)) return false;
    if (mesh.footprint(side, x).inside < -ramp || shallowest(side, x) != side) return false;
    for (const TriangleMesh::MeshBorder &border : mesh.sides()[side].borders) {
      if (!border.is_convex || !border.is_sharp || depth(border.beyond, x) >= own) continue;
      const Vec3 from = x - border.from;
      const double along = dot(from, border.along), aside = dot(from, border.outward);
      const bool is_near = along >= -ramp && along <= border.length + ramp && aside >= -(own + ramp) && aside <= ramp;
      if (!is_near) continue;    // far beyond it there may be the same side again, across a hole
      if (!leads_in(border.beyond, corner, in_owner)) return false;
    }
    return true;
  }

 private:
  static constexpr int MOST_MOVES = 64;
  template <class Turn> bool leads_in(int side, const Polyhedron::Corner &corner, const Turn &in_owner) const
  {
    const Vec3 n = in_owner(mesh.sides()[side].normal);
    return std::any_of(corner.ways.begin(), corner.ways.end(), [&](const Vec3 &way) { return dot(way, n) < LEADS_IN; });
  }
  const TriangleMesh &mesh;
  double ramp;
  const std::vector<int> &near;
};

template <class Turn>
bool is_born_below(const MeshHost &host, int side, const Polyhedron::Corner &corner, const Turn &in_owner, const Vec3 &x,
                   double deepest)
{ return host.is_below(side, corner, in_owner, x, deepest); }

}    // namespace mdanim
