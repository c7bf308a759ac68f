// SPDX-License-Identifier: GPL-2.0-only
// The moment in which a spring breaks, its remainder, and the energy that is gone.
//
// A spring is gone for good from the first step x^n on at whose places it, or one of the stretches that it lies over, is longer
// than a limit, (1 + e) times the length in the body without load: r^2 > limit^2. Places alone decide, so all springs that break
// in a step break together, and both ends find the same.
//
// A spring over two links, k2 and R0, lets go with either of them. A remainder of it stays along the other one, a spring of 2 k2
// and R0/2. So each piece of a rope is a rope, and free of stress where it is without load.
//
// V and F^n are those of the springs that there are from step n on, V' and F' of those before. In the leap-frog the last step has
// done the work (F'^{n-1} + F^n)/2 . (x^n - x^{n-1}). For forces linear in r, V'^n - V'^{n-1} = -(F'^{n-1} + F'^n)/2 . (x^n -
// x^{n-1}), so what is lost is
//   V'^n - V^n + (F'^n - F^n)/2 . dt v,   v at the half step before,
// of which each end of a spring counts its own half.

#pragma once

#include "springs/law.h"

#include <cmath>

namespace mdanim {

// Whether a stretch between two particles is longer than its limit, which is 0 where there is none.
inline bool is_too_long(const Vec3 &apart, double limit) { return limit > 0.0 && dot(apart, apart) > limit * limit; }

// The remainder along a link of a spring over it and another one; k is 0 where there is none.
struct Remainder {
  double k, r0;     // [force/length], [length]
  double stored;    // energy without load

  Spring spring() const { return {0.5 * k, r0, 0.0}; }
  // Energy beyond that without load.
  double energy(double r) const { return mdanim::energy(spring(), r) - stored; }
};

// F_i of a spring to a particle from which i is `apart`, without its dashpot.
inline Vec3 force_of(const Spring &spring, const Vec3 &apart)
{
  const SpringCoeffs own(spring);
  return spring_factor(own.push, own.pull, floored_square(apart)) * apart;
}

// Part of particle i in V + F/2 . dt v of a spring with this energy without load, where i moved by `way` in the last step.
inline double lost_with(const Spring &spring, double stored, const Vec3 &apart, const Vec3 &way)
{ return 0.5 * (energy(spring, std::sqrt(dot(apart, apart))) - stored + dot(force_of(spring, apart), way)); }

}    // namespace mdanim
