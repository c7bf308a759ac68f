// SPDX-License-Identifier: GPL-2.0-only
// Who is near whom, for AVX2.

#include "engine/touch_kernel.h"

namespace mdanim {

const Touch touch_avx2 = {in_reach, within};

}    // namespace mdanim
