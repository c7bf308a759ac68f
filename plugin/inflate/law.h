// SPDX-License-Identifier: GPL-2.0-only
// Gas that is shut in by a surface.

#pragma once

#include "numbers/vec3.h"

#include <cmath>

namespace mdanim {

// An ideal gas at the temperature of what is outside, whose pressure is p0. With the pressure p above p0 in the volume V:
//   (p + p0) V = C
//   U(V) = p0 (V - V*) - C ln(V/V*),   V* = C/p0 where p = 0;   p = -dU/dV;   U >= 0 is what the gas can still give
// Without anything outside, p0 = 0, U(V) = -C ln(V/V0) from the volume V0 at the start on.
struct GasLaw {
  double outside;    // p0
  double amount;     // C
  double start;      // V0

  double pressure(double volume) const { return amount / volume - outside; }
  double energy(double volume) const
  {
    if (outside == 0.0) return -amount * std::log(volume / start);
    const double rest = amount / outside;
    return outside * (volume - rest) - amount * std::log(volume / rest);
  }
};

// Six times the part of a triangle in the volume that a closed surface of them has, each counter-clockwise seen from outside; by
// places about any one point.
inline double sixth_of_volume(const Vec3 &a, const Vec3 &b, const Vec3 &c) { return dot(a, cross(b, c)); }

// The area of a triangle with the direction of its outward normal, times 2. A sixth of it is its part in dV/dx of each corner:
// together with the triangles around a corner this is the gradient.
inline Vec3 twice_area(const Vec3 &a, const Vec3 &b, const Vec3 &c) { return cross(b - a, c - a); }

}    // namespace mdanim
