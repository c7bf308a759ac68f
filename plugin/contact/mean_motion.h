// SPDX-License-Identifier: GPL-2.0-only
// How an object has moved in a step.

#pragma once

#include "contact/contact_kernel.h"
#include "contact/contact_object.h"

#include <algorithm>
#include <cmath>
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
  one.usual = mean;
}

// Sets it from all of the particles in a step, which go to their places. Displacements are compared with the mean one of the step
// before, so most objects are gone over once; again where the mean is another one now. `is_counted`: the object has been told of
// the motion, and nothing has moved since.
inline void tell_motion(ContactObject &one, const ContactKernels &kernels, MoveTask task, bool is_counted)
{
  constexpr double OTHER = 0.02;    // of the largest displacement relative to it
  if (!is_counted) task.about = one.usual;
  MovedBy moved = kernels.move(task);
  const auto other = [&] { return length(moved.mean - task.about); };
  if (!is_counted && other() > OTHER * std::sqrt(moved.square)) {
    task.about = moved.mean;
    moved = kernels.move(task);
  }
  one.has_moved(moved.mean, std::sqrt(moved.square) + other());
  if (!is_counted) one.usual = one.way;
  one.outline.follow(one.way, one.stir, task.now + one.first_slot);
}

}    // namespace mdanim
