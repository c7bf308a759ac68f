// SPDX-License-Identifier: GPL-2.0-only
// A place of a particle or a force on it, as wide as a vector that kernels read and write at once. Plain data; simd/of_set.h says
// why.

#pragma once

#include "numbers/vec3.h"

namespace mdanim {

struct alignas(4 * sizeof(double)) PaddedVec3 {
  Vec3 value;
  double unused = 0.0;
};

}    // namespace mdanim
