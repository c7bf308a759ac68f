// SPDX-License-Identifier: GPL-2.0-only
// How an object has moved in a step.

#pragma once

#include "contact/contact_object.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace mdanim {

// Displacements of many particles: their mean, and the largest one of any of them relative to it. The mean is better than one of
// them: an object that turns has particles that go twice as far relative to one at its rim.
class MeanMotion {
 public:
  MeanMotion() = default;
  explicit MeanMotion(const std::vector<Vec3> &changes)
  {
    for (const Vec3 &change : changes) add(change);
    take_mean();
    for (const Vec3 &change : changes) compare(change);
  }
  void add(const Vec3 &change) { sum += change, ++number; }
  // To be called when all have been added; then compare() with each of them.
  void take_mean()
  {
    if (number > 0) way = (1.0 / number) * sum;
  }
  void compare(const Vec3 &change)
  {
    const Vec3 off = change - way;
    square = std::max(square, dot(off, off));
  }
  void tell(ContactObject &one) const { one.way = way, one.stir = one.body->leverage() * std::sqrt(square); }

 private:
  Vec3 sum, way;
  double square = 0.0;
  int number = 0;
};

}    // namespace mdanim
