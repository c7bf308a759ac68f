// SPDX-License-Identifier: GPL-2.0-only
// The kernels for one set of instructions: CMake compiles this file once for each, with its flags, and MDANIM_SET and
// MDANIM_LANES. Nothing inline may come from here into the rest of the program, which runs on processors without these
// instructions: all that is included is always inlined or in an unnamed namespace.

#include "barrier/pair_filter_kernel.h"
#include "passes/kernels.h"
#include "passes/pass_kernel.h"

#define MDANIM_NAME_OF(set) #set
#define MDANIM_NAME(set) MDANIM_NAME_OF(set)
#define MDANIM_KERNELS_OF(set) kernels_##set
#define MDANIM_KERNELS(set) MDANIM_KERNELS_OF(set)

namespace mdanim {
namespace {

void spring_forces(int n, const double *__restrict push, const double *__restrict pull, double *__restrict x,
                   double *__restrict y, double *__restrict z)
{
  for (int b = 0; b < n; ++b) {
    const Vec3 d{x[b], y[b], z[b]};
    const Vec3 force = spring_factor(push[b], pull[b], floored_square(d)) * d;
    x[b] = force.x;
    y[b] = force.y;
    z[b] = force.z;
  }
}

void spring_energies(int n, const double *__restrict x, const double *__restrict y, const double *__restrict z,
                     const double *__restrict r0, double *__restrict K)
{
  for (int b = 0; b < n; ++b) {
    const Vec3 d{x[b], y[b], z[b]};
    K[b] = energy({K[b], r0[b], 0.0}, root(dot(d, d)));
  }
}

bool runs_here()
{
#if defined(__AVX512F__)
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
#elif defined(__AVX2__)
  return __builtin_cpu_supports("avx2");
#else
  return true;
#endif
}

}    // namespace

extern const Kernels MDANIM_KERNELS(MDANIM_SET);
const Kernels MDANIM_KERNELS(MDANIM_SET) = {MDANIM_NAME(MDANIM_SET), MDANIM_LANES,  runs_here,      pass_of_range,
                                            {in_reach, within},      spring_forces, spring_energies};

}    // namespace mdanim
