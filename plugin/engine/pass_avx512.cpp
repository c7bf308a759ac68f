// SPDX-License-Identifier: GPL-2.0-only
// The pass for AVX-512.

#define LANES 8
#include "engine/pass_kernel.h"

namespace mdanim {

void pass_avx512(Pass &pass) { whole_pass(pass); }

}    // namespace mdanim
