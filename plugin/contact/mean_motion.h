// SPDX-License-Identifier: GPL-2.0-only
// How an object has moved in a step.

#pragma once

#include "contact/contact_object.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace mdanim {

// Sets the motion of an object from displacements of many of its particles: their mean, and the largest one of any of them
// relative to it. The mean is better than one of them: an object that turns has particles that go twice as far relative to one at
// its rim.
inline void tell_mean_motion(ContactObject &one, const std::vector<Vec3> &changes)
{
  Vec3 mean;
  for (const Vec3 &change : changes) mean += change;
  if (!changes.empty()) mean = (1.0 / static_cast<double>(changes.size())) * mean;
  double square = 0.0;
  for (const Vec3 &change : changes) square = std::max(square, dot(change - mean, change - mean));
  one.has_moved(mean, std::sqrt(square));
  one.usual = changes.empty() ? std::nullopt : std::optional(mean);
}

}    // namespace mdanim
