// SPDX-License-Identifier: GPL-2.0-only
// Who is near whom, for any processor (on x86-64 SSE2, two vectors to a strip).

#include "engine/touch_kernel.h"

namespace mdanim {

const Touch touch_common = {in_reach, within};

}    // namespace mdanim
