// SPDX-License-Identifier: GPL-2.0-only
// The tables of all effects for one set of instructions (of_set.h).

#include "simd/kernels.h"
#include "simd/of_set.h"

#define MDANIM_WORD_OF(set) #set
#define MDANIM_WORD(set) MDANIM_WORD_OF(set)

namespace mdanim {

extern const SpringKernels MDANIM_OF_SET(spring_kernels);
extern const PairFilter MDANIM_OF_SET(pair_filter);
extern const ContactKernels MDANIM_OF_SET(contact_kernels);
extern const WaveKernels MDANIM_OF_SET(wave_kernels);
void MDANIM_OF_SET(pass_of_range)(Pass &);

static bool runs_here()
{
#if defined(__AVX512F__)
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
#elif defined(__AVX2__)
  return __builtin_cpu_supports("avx2");
#else
  return true;
#endif
}

extern const Kernels MDANIM_OF_SET(kernels);
const Kernels MDANIM_OF_SET(kernels) = {MDANIM_WORD(MDANIM_SET),
                                        MDANIM_LANES,
                                        runs_here,
                                        MDANIM_OF_SET(pass_of_range),
                                        MDANIM_OF_SET(spring_kernels),
                                        MDANIM_OF_SET(pair_filter),
                                        MDANIM_OF_SET(contact_kernels),
                                        MDANIM_OF_SET(wave_kernels)};

}    // namespace mdanim
