// SPDX-License-Identifier: GPL-2.0-only
// The vector code for one set of instructions, and which sets this processor runs. This is the only dispatch: an effect declares
// the table of its loops here, and defines it in a file NAME_of_set.cpp (of_set.h).

#pragma once

#include <vector>

namespace mdanim {

struct ContactKernels;    // contact/contact_kernel.h
struct PairFilter;        // barrier/pair_filter.h
struct Pass;              // passes/pass.h
struct SpringKernels;     // springs/spring_kernels.h
struct WaveKernels;       // liquid/waves/waves_kernels.h

// All sets give the same bits. `runs_here` must be true before any other function of a set is called.
struct Kernels {
  const char *name;
  int lanes;    // of a block
  bool (*runs_here)();
  void (*pass)(Pass &);
  const SpringKernels &springs;
  const PairFilter &pair_filter;
  const ContactKernels &contact;
  const WaveKernels &waves;
};

// All sets that run on this processor, the widest vectors first.
const std::vector<const Kernels *> &kernels_here();
inline const Kernels &widest_kernels() { return *kernels_here().front(); }
// Null when the name is unknown or does not run here.
const Kernels *kernels_named(const char *name);

}    // namespace mdanim
