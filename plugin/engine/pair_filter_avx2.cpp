// SPDX-License-Identifier: GPL-2.0-only
// Who is near whom, for AVX2.

#include "engine/pair_filter_kernel.h"

namespace mdanim {

const PairFilter pair_filter_avx2 = {in_reach, within};

}    // namespace mdanim
