// SPDX-License-Identifier: GPL-2.0-only
// The vector code of the engine, once for each set of instructions, and which of them this processor runs.

#ifndef MDANIM_KERNELS_H
#define MDANIM_KERNELS_H

#include "barrier/pair_filter.h"
#include "passes/pass.h"

#include <vector>

namespace mdanim {

// One set of instructions: the same bits from each of them. CMake compiles kernels_of_set.cpp once for each; `runs_here` must be
// true before anything else of it is called.
struct Kernels {
  const char *name;
  int lanes;    // of a block
  bool (*runs_here)();
  void (*pass)(Pass &);
  PairFilter pair_filter;
  // r_ij -> F_i of n springs.
  void (*spring_forces)(int n, const double *push, const double *pull, double *x, double *y, double *z);
  // r_ij -> energies of n springs, in the place of K.
  void (*spring_energies)(int n, const double *x, const double *y, const double *z, const double *r0, double *K);
};

// All that run here, the widest vectors first.
const std::vector<const Kernels *> &kernels_here();
inline const Kernels &widest_kernels() { return *kernels_here().front(); }
// Null when the name is unknown or does not run here.
const Kernels *kernels_named(const char *name);

}    // namespace mdanim

#endif
