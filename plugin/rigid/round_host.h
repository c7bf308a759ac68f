// SPDX-License-Identifier: GPL-2.0-only
// Cylinders, cones and tori as hosts of corners and rims, in their own frame: side 0 is the curved one, the others are flat ends.

#pragma once

#include "rigid/pair.h"

#include <cmath>

namespace mdanim {

class RoundHost {
 public:
  RoundHost(const SolidShape &shape, double ramp) : shape(shape), ramp(ramp), round(shape.curves()[0]) {}

  int sides() const { return static_cast<int>(shape.curves().size()); }
  template <class Visit> void each_flat_side(const Visit &visit) const
  {
    for (int side = 1; side < sides(); ++side) visit(side);
  }
  static bool is_open(int) { return true; }
  Vec3 normal(int side, const Vec3 &x) const
  {
    if (side > 0) return end(side).along;
    const Vec3 away = x - closest(round, x).at;
    const double far = length(away);
    return far > 0.0 ? (1.0 / far) * away : shape.axis(0);
  }
  double depth(int side, const Vec3 &x) const
  {
    if (side > 0) return dot(end(side).along, end(side).middle - x);
    const CurvePoint foot = closest(round, x);
    const Vec3 away = x - foot.at;
    return foot.radius - length(away);
  }
  double outside(const Vec3 &x) const
  {
    double least = HUGE_VAL;
    for (int side = 0; side < sides(); ++side) least = std::min(least, depth(side, x));
    return -least;
  }
  // The part fades over the ramp at the rims.
  double part(int side, const Vec3 &x, Vec3 &slope) const
  {
    double part = 1.0;
    slope = Vec3();
    if (side > 0) {
      const Vec3 from = x - end(side).middle, across = from - dot(from, end(side).along) * end(side).along;
      const double out = length(across);
      double steep;
      part = smooth_step(end(side).size - out, ramp, steep);
      if (steep != 0.0) slope = (-steep / out) * across;
      return part;
    }
    for (int k = 1; k < sides(); ++k) {
      double steep;
      const double one = smooth_step(depth(k, x), ramp, steep);
      slope = one * slope - (part * steep) * end(k).along;
      part *= one;
    }
    return part;
  }
  int shallowest(int side, const Vec3 &) const { return side; }

 private:
  const Curve &end(int side) const { return shape.curves()[side]; }
  const SolidShape &shape;
  double ramp;
  const Curve &round;
};

}    // namespace mdanim
