// SPDX-License-Identifier: GPL-2.0-only
// A triangle of a surface that may be curved: the cubic patch with given normals at its corners of A. Vlachos, J. Peters, C.
// Boyd, J. L. Mitchell, "Curved PN triangles", Proc. I3D 2001, 159-166. Two patches with the same normals at a common edge have
// the same curve there.

#pragma once

#include "numbers/vec3.h"

namespace mdanim {

// A point of a triangle: inside of it, on edge k from corner k to the next one, or at corner k.
struct TrianglePoint {
  enum Feature { INSIDE, EDGE, CORNER };
  Vec3 at;
  double distance = 0.0;
  Feature feature = INSIDE;
  int number = 0;
};

class CurvedTriangle {
 public:
  CurvedTriangle() = default;
  // Edge k is straight where `is_straight[k]`.
  CurvedTriangle(const Vec3 (&corner)[3], const Vec3 (&normal)[3], const bool (&is_straight)[3]);

  bool is_flat() const { return flat; }
  const Vec3 &corner(int k) const { return its_corner[k]; }
  // How far the patch is from the flat triangle, at most.
  double bulge() const { return its_bulge; }
  TrianglePoint closest(const Vec3 &x) const;
  // The normal of the flat triangle, outward; its length is not 1.
  Vec3 flat_normal() const { return cross(its_corner[1] - its_corner[0], its_corner[2] - its_corner[0]); }

 private:
  struct Place {
    double u, v;    // at = corner 0 + u (corner 1 - corner 0) + v (corner 2 - corner 0) of a flat one
  };
  struct Jet {
    Vec3 at, u, v, uu, uv, vv;    // the point and its derivatives
  };
  Jet jet(const Place &p) const;
  TrianglePoint closest_of_flat(const Vec3 &x, Place &place) const;
  bool find_inside(const Vec3 &x, Place &place) const;
  TrianglePoint closest_of_edge(int edge, const Vec3 &x) const;

  Vec3 its_corner[3];
  Vec3 by_u, by_v, by_uu, by_uv, by_vv, by_uuu, by_uuv, by_uvv, by_vvv;    // coefficients of powers
  double its_bulge = 0.0;
  bool flat = true;
};

}    // namespace mdanim
