// SPDX-License-Identifier: GPL-2.0-only
// Points of ellipsoids by their normals.

#pragma once

#include "rigid/solid.h"

#include <cmath>

namespace mdanim {

// Where an ellipsoid is touched by a plane with the normal n, from its middle and in the frame of its body, and the mean of both
// radii of its curvature there: its support function is h = |D n| with D the half axes, and the radii are the eigenvalues of the
// second derivatives of h.
struct EggPoint {
  Vec3 at;
  double radius;
  EggPoint(const Solid &one, const Vec3 &n)
  {
    const Vec3 &half = one.shape.half_axes();
    const double along[3] = {dot(n, one.shape.axis(0)), dot(n, one.shape.axis(1)), dot(n, one.shape.axis(2))},
                 square[3] = {half.x * half.x, half.y * half.y, half.z * half.z};
    double h = 0.0, fourth = 0.0;
    for (int k = 0; k < 3; ++k) h += square[k] * along[k] * along[k], fourth += square[k] * square[k] * along[k] * along[k];
    h = std::sqrt(h);
    for (int k = 0; k < 3; ++k) at += (square[k] * along[k] / h) * one.shape.axis(k);
    radius = 0.5 * ((square[0] + square[1] + square[2]) / h - fourth / (h * h * h));
  }
};

}    // namespace mdanim
