// SPDX-License-Identifier: GPL-2.0-only
// The force between a boundary particle of one object and an inner particle of another. Wcislo 1999, sec. 3.3 (boundary against
// sub-boundary); the form of the law is ours, docs/fix_mdanim_barrier.md.

#pragma once

#include "numbers/vec3.h"

namespace mdanim {

// How a particle takes part in contact.
enum Role : int { NONE = 0, BARRIER = 1, BOUNDARY = 2, THIN = 4 };    // THIN comes with BOUNDARY

// Reach of the barrier between two particles of different objects, as a multiple of the larger of their own:
// 1 between boundary and barrier, `thin_ratio` between boundary and boundary when one of them has nothing
// behind it, else 0.
inline double reach_factor(int a, int b, double thin_ratio)
{
  if ((a & BOUNDARY && b & BARRIER) || (a & BARRIER && b & BOUNDARY)) return 1.0;
  if (a & BOUNDARY && b & BOUNDARY && (a | b) & THIN) return thin_ratio;
  return 0.0;
}

// Two springs of stiffness a and b in series, doubled: equal ones give their own stiffness.
inline double pair_stiffness(double a, double b) { return a + b > 0.0 ? 2.0 * (a * b) / (a + b) : 0.0; }

// q = 1 - r/rc, for r < rc. Exactly zero at r >= rc.
//   U = k rc^2/3 q^3, |F| = k rc q^2
inline double barrier_energy(double k, double rc, double q) { return k * rc * rc / 3.0 * (q * q * q); }

inline double barrier_force(double k, double rc, double q) { return k * rc * (q * q); }

// Unit vector from j to i. Two particles at the same place are pushed apart along x, the one of the lower tag towards -x.
inline Vec3 direction(const Vec3 &rij, double r, bool i_has_lower_tag)
{
  if (r > 0.0) return {rij.x / r, rij.y / r, rij.z / r};
  return {i_has_lower_tag ? -1.0 : 1.0, 0.0, 0.0};
}

}    // namespace mdanim
