// SPDX-License-Identifier: GPL-2.0-only
// The directions of bodies that a joint holds or measures, as both patches have them.

#pragma once

#include "joints/patch.h"
#include "joints/words.h"

namespace mdanim {

// Unit vectors at the start.
struct JointDirections {
  Vec3 held[3];    // a hinge's axis; of welds and sliders all
  int many = 0;    // of those that are held
  Vec3 across;     // of a hinge, for its angle
};

// Both throw std::runtime_error: when a patch does not have the place d, or the axis or the directions of a joint.
void expect_place(const Patch &patch, const Vec3 &d);
JointDirections directions_of(const JointWords &words, const Patch &a, const Patch &b);

}    // namespace mdanim
