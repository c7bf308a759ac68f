// SPDX-License-Identifier: GPL-2.0-only
// A spring between two particles, and the dashpot beside it, for a double or all lanes of a vector unit at once (real.h).
// Wcislo 1999, eq. (3.6), (3.7) with the sign set right: V(r) = k/2 (r - r0)^2 = K (r - r0)^2 with LAMMPS's K = k/2,
//   F_i = -2K (r - r0) n,  n = (r_i - r_j) / r.

#pragma once

#include "numbers/vec3.h"

namespace mdanim {

// A spring as a scene or an input script gives it.
struct Spring {
  double K = 0.0;     // [energy/length^2]
  double r0 = 0.0;    // rest length [length]
  double c = 0.0;     // dashpot along the spring [force/velocity]; 0 for none
};

// Coefficients of a spring's force, F_i = (push / r - pull) r_ij, since -2K (r - r0) / r = 2K r0 / r - 2K; and its dashpot.
struct SpringCoeffs {
  double push, pull, c;
  explicit SpringCoeffs(const Spring &s) : push(2.0 * s.K * s.r0), pull(2.0 * s.K), c(s.c) {}
  bool operator==(const SpringCoeffs &other) const { return push == other.push && pull == other.pull && c == other.c; }
};

// Small enough to change no r^2 that is not 0. Coincident particles get zero force instead of NaN.
constexpr double R2_FLOOR = 1e-300;

// r^2 as the laws below use it.
template <class Real> MDANIM_ALWAYS_INLINE Real floored_square(const Vec<Real> &rij) { return dot(rij, rij) + R2_FLOOR; }

// F_i / r_ij of the spring.
template <class Real> MDANIM_ALWAYS_INLINE Real spring_factor(const Real &push, const Real &pull, const Real &square)
{ return push / root(square) - pull; }

// The rate at which the distance grows, relative to it. The dashpot's part of the same factor is -c times that:
// F_i = -c (v_ij . n) n = -c [(v_ij . r_ij) / r^2] r_ij.
template <class Real> MDANIM_ALWAYS_INLINE Real strain_rate(const Vec<Real> &rij, const Vec<Real> &vij, const Real &square)
{ return dot(vij, rij) / square; }

MDANIM_ALWAYS_INLINE double energy(const Spring &s, double r) { return s.K * (r - s.r0) * (r - s.r0); }

}    // namespace mdanim
