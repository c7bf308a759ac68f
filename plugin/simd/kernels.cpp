// SPDX-License-Identifier: GPL-2.0-only
// The choice among sets of instructions. MDANIM_SETS names them as MDANIM_A_SET(avx512) MDANIM_A_SET(avx2) ..., in the order of
// sets.txt.

#include "simd/kernels.h"

#include <algorithm>
#include <cstring>
#include <iterator>

namespace mdanim {

#define MDANIM_A_SET(set) extern const Kernels kernels_##set;
MDANIM_SETS
#undef MDANIM_A_SET

#define MDANIM_A_SET(set) &kernels_##set,
static const Kernels *const ALL[] = {MDANIM_SETS};
#undef MDANIM_A_SET

const std::vector<const Kernels *> &kernels_here()
{
  static const std::vector<const Kernels *> here = [] {
    std::vector<const Kernels *> found;
    std::copy_if(std::begin(ALL), std::end(ALL), std::back_inserter(found), [](const Kernels *k) { return k->runs_here(); });
    return found;
  }();
  return here;
}

const Kernels *kernels_named(const char *name)
{
  for (const Kernels *kernels : kernels_here())
    if (std::strcmp(kernels->name, name) == 0) return kernels;
  return nullptr;
}

}    // namespace mdanim
