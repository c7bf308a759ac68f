// SPDX-License-Identifier: GPL-2.0-only
// The pass for AVX2.

#define LANES 4
#include "engine/pass_kernel.h"

namespace mdanim {

void pass_avx2(Pass &pass) { whole_pass(pass); }

}    // namespace mdanim
