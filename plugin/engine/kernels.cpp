// SPDX-License-Identifier: GPL-2.0-only
// The choice among sets of instructions: the only place that knows which there are.

#include "engine/kernels.h"

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

template <class Wanted> static const Kernels *first(Wanted wanted)
{
  const auto found = std::find_if(std::begin(ALL), std::end(ALL), [&](const Kernels *k) { return wanted(*k) && k->runs_here(); });
  return found == std::end(ALL) ? nullptr : *found;
}

// The divider gives as many numbers a cycle to wide vectors as to narrow ones, and of wide ones more lanes are idle. Dashpots are
// more to do besides.
const Kernels &best_kernels(bool damped)
{
  return *first([damped](const Kernels &k) { return damped || k.lanes == kernels_common.lanes; });
}

const Kernels *kernels_named(const char *name)
{
  return first([name](const Kernels &k) { return std::strcmp(k.name, name) == 0; });
}

const Kernels &widest_kernels() { return best_kernels(true); }

}    // namespace mdanim
