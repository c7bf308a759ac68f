// SPDX-License-Identifier: GPL-2.0-only
// The angle of a hinge and its derivatives.

#pragma once

#include "numbers/portable.h"
#include "numbers/vec3.h"

#include <cmath>

namespace mdanim {

// The angle q of the direction `to` seen from `from`, about the sum s of the axes of both bodies, n = s/|s|:
//   y = n·(from x to),   x = from·to - (n·from)(n·to),   q = atan2(y, x),   dq = by_from·dfrom + by_to·dto + by_axes·ds.
// It stays when all is turned; so forces along its derivatives leave the angular momentum of both bodies as it is.
struct HingeAngle {
  double q;    // from -pi to pi
  Vec3 by_from, by_to, by_axes;
};

inline HingeAngle hinge_angle(const Vec3 &from, const Vec3 &to, const Vec3 &axes)
{
  const double over = 1.0 / length(axes);
  const Vec3 n = over * axes, side = cross(from, to);
  const double along_from = dot(n, from), along_to = dot(n, to), y = dot(n, side), x = dot(from, to) - along_from * along_to;
  const double square = x * x + y * y, by_y = x / square, by_x = -y / square;
  const Vec3 by_n = by_y * side - by_x * (along_to * from + along_from * to);
  return {angle_of(y, x), by_y * cross(to, n) + by_x * (to - along_to * n),
          by_y * cross(n, from) + by_x * (from - along_from * n), over * (by_n - dot(n, by_n) * n)};
}

}    // namespace mdanim
