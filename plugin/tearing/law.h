// SPDX-License-Identifier: GPL-2.0-only
// The moment in which a spring breaks, its remainder, and the energy that is gone.
//
// A spring is gone for good from the first step x^n on at whose places it, or one of the stretches that it lies over, is longer
// than a limit, (1 + e) times the length in the body without load: r^2 > limit^2. Places alone decide, so all springs that break
// in a step break together, and both ends find the same.
//
// A spring over two links of lengths L1 and L2, k2 and R0, lets go with either of them. A remainder of it stays along the other
// one, L1 for example, a spring of k2 (L1 + L2)/L1 and R0 L1/(L1 + L2): both remainders in a row are the spring itself. So each
// piece of a rope or a flat sheet is one, and free of stress where it is without load. Where the links are not in a row, as in
// curved sheets, the spring is shorter, L < L1 + L2, and R0 + L1 + L2 - L takes the place of R0: the push k2 (R0 - L) stays.
//
// V and F^n are those of the springs that there are from step n on, V' and F' of those before, and D^n = F'^n - F^n. Leap-frog
// conserves to fourth order
//   V + sum of m v^2/2 - dt u.(F^n - F^{n-1})/12 - dt^2 F^n^2/24 m,   v = u + dt F^n/2 m,   u = v^{n-1/2},
// (fix_mdanim_leapfrog.md). At the same x^n and u the two differ by
//   V' - V + sum of dt u.D^n/2 - dt u.(D^n - D^{n-1})/12 + dt^2 (2 F^n + D^n).D^n/12 m,
// which is what is lost. Each end of a spring counts its own half.

#pragma once

#include "springs/law.h"

#include <cmath>

namespace mdanim {

// Whether a stretch between two particles is longer than its limit, which is 0 where there is none.
inline bool is_too_long(const Vec3 &apart, double limit) { return limit > 0.0 && dot(apart, apart) > limit * limit; }

// A spring, and its length in the body without load.
struct LoadFree {
  Spring spring;    // without a dashpot
  double length;
  double more = 0.0;    // energy beside that of its stretch

  double stored() const { return mdanim::energy(spring, length); }
  // Energy beyond that without load.
  double energy(double r) const { return mdanim::energy(spring, r) - stored() + more; }
};

// The remainder along a link of the length `link` of a spring over it and another one, together `both` long.
inline LoadFree remainder_of(const LoadFree &over, double link, double both)
{
  const double part = link / both, rest = over.spring.r0 + (both - over.length);
  return {{over.spring.K / part, rest * part, 0.0}, link};
}

// F_i of a spring to a particle from which i is `apart`, without its dashpot.
inline Vec3 force_of(const Spring &spring, const Vec3 &apart)
{
  const SpringCoeffs own(spring);
  return spring_factor(own.push, own.pull, floored_square(apart)) * apart;
}

// dt u.D^n/2 - dt u.(D^n - D^{n-1})/12 of a particle, by forces now and a step before, and its own motion between them.
inline double work_of(const Vec3 &now, const Vec3 &then, const Vec3 &way)
{ return dot(5.0 / 12.0 * now + 1.0 / 12.0 * then, way); }

// Part of particle i in V' - V + dt u.D^n/2 - dt u.(D^n - D^{n-1})/12 of a spring that is there no longer. `apart` and `before`
// are where it is from the other particle, in this step and in the last one, `way` is its own motion between them.
inline double lost_with(const LoadFree &of, const Vec3 &apart, const Vec3 &before, const Vec3 &way)
{
  const Vec3 now = force_of(of.spring, apart), then = force_of(of.spring, before);
  return 0.5 * of.energy(std::sqrt(dot(apart, apart))) + work_of(now, then, way);
}

// The rest of it, dt^2 (2 F^n + D^n).D^n/12 m, from all springs of a particle that are there no longer.
inline double lost_with_kick(const Vec3 &force, const Vec3 &less, double mass, double dt)
{ return dt * dt / (12.0 * mass) * dot(2.0 * force + less, less); }

}    // namespace mdanim
