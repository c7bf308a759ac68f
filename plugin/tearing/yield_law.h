// SPDX-License-Identifier: GPL-2.0-only
// A spring that yields: its rest length follows, so that it never bears more than k b.
//
// L is the rest length of the spring at the start, p what it has grown by for good, and k the same for ever:
//   F = -k (r - L - p),   and before the forces of each step   p = r - L -+ b   where   +-(r - L - p) > b,
// ideal plasticity, but p is at least -L/2: a spring that was pushed to half of its length is elastic from there on, as nothing
// is pressed to no volume. Both ends find the same p, from r^2 alone.
//
// The energy that is gone is that of a spring of the rest length before, which is there no longer, less that of the new one
// (law.h).

#pragma once

#include "tearing/law.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

constexpr double SHRINKS = 0.5;    // at most, of its first rest length

// Growth of a spring of the first rest length r0 that is longer than it by `stretch`: that before, or another one where it bears
// no more than a stretch `most`.
inline double grown(double r0, double stretch, double before, double most)
{
  if (std::abs(stretch - before) <= most) return before;
  return std::max(stretch - std::copysign(most, stretch - before), -SHRINKS * r0);
}

// A spring that has grown, without load.
inline LoadFree grown_spring(double K, double r0, double growth) { return {{K, r0 + growth, 0.0}, r0 + growth}; }

// F_i/r_ij of a spring that has grown, beyond that of the spring before: 2 K p/r.
inline double growth_factor(double K, double growth, double r) { return 2.0 * K * growth / r; }

// Energy of it beyond that of the spring before, for a spring that is longer than its first rest length by `stretch`.
inline double growth_energy(double K, double growth, double stretch) { return K * growth * (growth - 2.0 * stretch); }

}    // namespace mdanim
