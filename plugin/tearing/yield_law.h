// SPDX-License-Identifier: GPL-2.0-only
// A spring that yields: its rest length follows, so that it never bears more than k b.
//
// L is the length of the spring at the start, without load, p what it has grown by for good, and k the same for ever:
//   F = -k (r - r0 - p),   and before the forces of each step   p = r - L -+ b   where   +-(r - L - p) > b,
// where r0 is L, but of springs that hold each other without load.
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

constexpr double SHRINKS = 0.5;    // at most, of its first length

// Growth of a spring of the first length L that is longer than it by `stretch`: that before, or another one where it bears no
// more than a stretch `most`.
inline double grown(double first, double stretch, double before, double most)
{
  if (std::abs(stretch - before) <= most) return before;
  return std::max(stretch - std::copysign(most, stretch - before), -SHRINKS * first);
}

// A spring that has grown, without load. A push P = k (r0 - L) stays as it is: its energy counts from the length L on, as that of
// what holds it does, and as a bend has it of which the spring over two links has become shorter.
inline LoadFree grown_spring(const LoadFree &first, double growth)
{
  const Spring &s = first.spring;
  return {{s.K, s.r0 + growth, 0.0}, first.length + growth, -2.0 * s.K * (s.r0 - first.length) * growth};
}

// F_i/r_ij of a spring that has grown, beyond that of the spring before: 2 K p/r.
inline double growth_factor(double K, double growth, double r) { return 2.0 * K * growth / r; }

// Energy of a spring that has grown beyond that of the spring before.
inline double growth_energy(const LoadFree &first, double growth, double r)
{ return first.spring.K * growth * (growth - 2.0 * (r - first.spring.r0)) + grown_spring(first, growth).more; }

}    // namespace mdanim
