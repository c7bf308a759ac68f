// SPDX-License-Identifier: GPL-2.0-only
// The pass for any processor (on x86-64 SSE2, two vectors to a block).

#define LANES 4
#include "engine/pass_kernel.h"

namespace mdanim {

void pass_common(Pass &pass) { whole_pass(pass); }

}    // namespace mdanim
