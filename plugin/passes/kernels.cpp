// SPDX-License-Identifier: GPL-2.0-only
// The choice among sets of instructions: the only place that knows which there are.

#include "passes/kernels.h"

#include <algorithm>
#include <cstring>
#include <iterator>

namespace mdanim {

extern const Kernels kernels_common;
#if defined(__x86_64__)
extern const Kernels kernels_avx2, kernels_avx512;
static const Kernels *const ALL[] = {&kernels_avx512, &kernels_avx2, &kernels_common};    // the widest first
#else
static const Kernels *const ALL[] = {&kernels_common};
#endif

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
