// SPDX-License-Identifier: GPL-2.0-only
// A spring between two particles, and the dashpot beside it.
// Wcislo 1999, eq. (3.6), (3.7) with the sign set right: V(r) = k/2 (r - r0)^2 = K (r - r0)^2 with LAMMPS's K
// = k/2,
//   F_i = -2K (r - r0) n,  n = (r_i - r_j) / r.

#ifndef MDANIM_SPRING_H
#define MDANIM_SPRING_H

#include "vec3.h"

namespace mdanim {

struct Spring {
  double K = 0.0;     // [energy/length^2]
  double r0 = 0.0;    // rest length [length]
  double c = 0.0;     // dashpot along the spring [force/velocity]; 0 for none
};

// The spring's F_i / r, so that F_i = pull r_ij. Two particles in one place have r_ij = 0, hence no force.
inline double pull(double K, double r0, double r) { return -2.0 * (K * (r - r0)) / (r > 0.0 ? r : 1.0); }

// The dashpot's part of the same factor: F_i = -c (v_ij . n) n = [-c (v_ij . r_ij) / r^2] r_ij.
inline double drag(double c, const Vec3 &rij, const Vec3 &vij)
{
  const double r2 = dot(rij, rij);
  return r2 > 0.0 ? -(c * dot(vij, rij)) / r2 : 0.0;
}

inline double energy(const Spring &s, double r) { return s.K * (r - s.r0) * (r - s.r0); }

}    // namespace mdanim

#endif
