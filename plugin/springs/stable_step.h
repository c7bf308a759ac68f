// SPDX-License-Identifier: GPL-2.0-only
// The largest stable time step of leap-frog with lagged dashpots (docs/physics-solids.md): dt^2 a + 2 dt b <= 4 for every
// particle.

#pragma once

#include "numbers/vec3.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mdanim {

// A symmetric matrix, the sum of w n n^T over the springs of a particle.
struct SymmetricBlock {
  double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, xz = 0.0, yz = 0.0;

  void add(double w, const Vec3 &n)
  {
    xx += w * n.x * n.x;
    yy += w * n.y * n.y;
    zz += w * n.z * n.z;
    xy += w * n.x * n.y;
    xz += w * n.x * n.z;
    yz += w * n.y * n.z;
  }

  // Uses the trigonometric solution of the cubic; exact to 1e-8 of the value.
  double largest_eigenvalue() const
  {
    const double mean = (xx + yy + zz) / 3.0, a = xx - mean, b = yy - mean, c = zz - mean;
    const double p = std::sqrt((a * a + b * b + c * c + 2.0 * (xy * xy + xz * xz + yz * yz)) / 6.0);
    if (p == 0.0) return mean;
    const double det = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
    return mean + 2.0 * p * std::cos(std::acos(std::clamp(det / (2.0 * p * p * p), -1.0, 1.0)) / 3.0);
  }
};

// a [1/time^2] and b [1/time]; infinite where both are 0. No difference of nearly equal numbers occurs.
inline double stable_step(double a, double b)
{
  const double sum = std::sqrt(b * b + 4.0 * a) + b;
  return sum > 0.0 ? 4.0 / sum : std::numeric_limits<double>::infinity();
}

}    // namespace mdanim
