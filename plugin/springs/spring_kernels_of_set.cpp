// SPDX-License-Identifier: GPL-2.0-only
// Loops over springs for one set of instructions.

#include "springs/spring_kernels.h"

#include "numbers/vec3.h"
#include "simd/of_set.h"
#include "springs/law.h"

namespace mdanim {
namespace {

template <bool DAMPED>
MDANIM_ALWAYS_INLINE void to_forces(int n, const double *__restrict push, const double *__restrict pull,
                                    const double *__restrict brake, double *__restrict x, double *__restrict y,
                                    double *__restrict z)
{
  for (int b = 0; b < n; ++b) {
    const Vec3 d{x[b], y[b], z[b]};
    double factor = spring_factor(push[b], pull[b], floored_square(d));
    if (DAMPED) factor -= brake[b];
    const Vec3 force = factor * d;
    x[b] = force.x;
    y[b] = force.y;
    z[b] = force.z;
  }
}

void forces(int n, const double *push, const double *pull, double *x, double *y, double *z)
{ to_forces<false>(n, push, pull, nullptr, x, y, z); }

void damped_forces(int n, const double *push, const double *pull, const double *brake, double *x, double *y, double *z)
{ to_forces<true>(n, push, pull, brake, x, y, z); }

void energies(int n, const double *__restrict x, const double *__restrict y, const double *__restrict z,
              const double *__restrict r0, double *__restrict K)
{
  for (int b = 0; b < n; ++b) {
    const Vec3 d{x[b], y[b], z[b]};
    K[b] = energy({K[b], r0[b], 0.0}, root(dot(d, d)));
  }
}

}    // namespace

extern const SpringKernels MDANIM_OF_SET(spring_kernels);
const SpringKernels MDANIM_OF_SET(spring_kernels) = {forces, damped_forces, energies};

}    // namespace mdanim
