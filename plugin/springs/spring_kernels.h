// SPDX-License-Identifier: GPL-2.0-only
// Loops over springs whose r_ij are side by side: the interface to the vector code (spring_kernels_of_set.cpp).

#pragma once

namespace mdanim {

struct SpringKernels {
  // r_ij -> F_i of n springs.
  void (*forces)(int n, const double *push, const double *pull, double *x, double *y, double *z);
  // The same with dashpots beside some; `brake` is c times the strain rate.
  void (*damped_forces)(int n, const double *push, const double *pull, const double *brake, double *x, double *y, double *z);
  // r_ij -> energies of n springs, written in place of K.
  void (*energies)(int n, const double *x, const double *y, const double *z, const double *r0, double *K);
};

}    // namespace mdanim
