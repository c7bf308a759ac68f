// SPDX-License-Identifier: GPL-2.0-only
// The pass over a range of blocks for one set of instructions.

#include "passes/immersed_kernel.h"
#include "simd/of_set.h"

namespace mdanim {

void MDANIM_OF_SET(pass_of_range)(Pass &);
void MDANIM_OF_SET(pass_of_range)(Pass &pass) { pass_of_range(pass); }

}    // namespace mdanim
