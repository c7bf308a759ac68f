// SPDX-License-Identifier: GPL-2.0-only
// A spring between two particles, and the dashpot beside it.
// Wcislo 1999, eq. (3.6), (3.7) with the sign set right: V(r) = k/2 (r - r0)^2 = K (r - r0)^2 with LAMMPS's K
// = k/2,
//   F_i = -2K (r - r0) n,  n = (r_i - r_j) / r.

#ifndef MDANIM_SPRING_H
#define MDANIM_SPRING_H

#include "laws/vec3.h"

#include <cmath>

namespace mdanim {

struct Spring {
  double K = 0.0;     // [energy/length^2]
  double r0 = 0.0;    // rest length [length]
  double c = 0.0;     // dashpot along the spring [force/velocity]; 0 for none
};

// What the force is made of: F_i = (push / r - pull) r_ij, since -2K (r - r0) / r = 2K r0 / r - 2K; and the dashpot.
struct SpringCoeffs {
  double push, pull, c;
  explicit SpringCoeffs(const Spring &s) : push(2.0 * s.K * s.r0), pull(2.0 * s.K), c(s.c) {}
  bool operator==(const SpringCoeffs &other) const { return push == other.push && pull == other.pull && c == other.c; }
};

// So small that it changes no r^2 that is not nothing, and two particles in one place, r_ij = 0, have no force instead of none
// that is a number.
constexpr double R2_FLOOR = 1e-300;

// F_i / r_ij for r^2.
inline double force_factor(double push, double pull, double r2) { return push / std::sqrt(r2 + R2_FLOOR) - pull; }

// The dashpot's part of the same factor: F_i = -c (v_ij . n) n = [-c (v_ij . r_ij) / r^2] r_ij.
inline double drag(double c, const Vec3 &rij, const Vec3 &vij) { return -(c * dot(vij, rij)) / (dot(rij, rij) + R2_FLOOR); }

inline double energy(const Spring &s, double r) { return s.K * (r - s.r0) * (r - s.r0); }

}    // namespace mdanim

#endif
