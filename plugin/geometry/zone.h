// SPDX-License-Identifier: GPL-2.0-only
// The space near an object in which something may be: a box, cut off across a direction. For two balls beside each other along a
// diagonal the boxes alone exclude little.

#pragma once

#include "geometry/boxes.h"
#include "numbers/vec3.h"

#include <algorithm>

namespace mdanim {

// The corner of a box that is farthest along a direction.
inline Vec3 farthest(const Box &box, const Vec3 &way)
{
  return {way.x > 0.0 ? box.high(0) : box.low(0), way.y > 0.0 ? box.high(1) : box.low(1), way.z > 0.0 ? box.high(2) : box.low(2)};
}

struct Zone {
  Box box;
  Vec3 across;    // unit vector, and the lowest coordinate along it; zero for no cut
  double from = -Box::FAR;

  Zone grown(double by) const { return {box.grown(by), across, from - by}; }
  // Lower bound of the distance of a place from the zone; negative inside.
  double outside(const Vec3 &x) const
  {
    const double at[] = {x.x, x.y, x.z};
    double out = from - dot(across, x);
    for (int d = 0; d < 3; ++d) out = std::max({out, box.low(d) - at[d], at[d] - box.high(d)});
    return out;
  }
  bool contains(const Vec3 &x) const { return dot(across, x) >= from && box.contains(&x.x); }
  // False where the zone and a box have no part in common.
  bool meets(const Box &other) const { return meet(box, other, 0.0) && dot(across, farthest(other, across)) >= from; }
};

}    // namespace mdanim
