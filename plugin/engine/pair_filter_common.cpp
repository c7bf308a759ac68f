// SPDX-License-Identifier: GPL-2.0-only
// Who is near whom, for any processor (on x86-64 SSE2, two vectors to a strip).

#include "engine/pair_filter_kernel.h"

namespace mdanim {

const PairFilter pair_filter_common = {in_reach, within};

}    // namespace mdanim
