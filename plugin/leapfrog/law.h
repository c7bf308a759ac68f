// SPDX-License-Identifier: GPL-2.0-only
// The two half steps of a velocity under force and friction, for a double or all lanes of a vector unit at once (real.h).
// Wcislo 1999, eq. (3.3), (3.10), (3.12), (3.13); symbols as there: phi = lambda dt / 2m.

#pragma once

#include "numbers/vec3.h"

#include <cstdint>
#include <cstring>
#include <type_traits>

namespace mdanim {

// Without friction: v <- v + k F in both halves, k = dt / 2m.
template <class Real> struct Frictionless {
  Real kick;    // dt / 2m [velocity/force]

  MDANIM_ALWAYS_INLINE Vec<Real> first_half(const Vec<Real> &v, const Vec<Real> &f) const { return v + kick * f; }
  MDANIM_ALWAYS_INLINE Vec<Real> final_half(const Vec<Real> &v, const Vec<Real> &f) const { return v + kick * f; }
};

// Friction taken implicitly. Wcislo 1999, eq. (3.12) in two halves that meet in v^n, which is (3.10):
//   v^n       = (v^{n-1/2} + k F) / (1 + phi),   v^{n+1/2} = (1 - phi) v^n + k F,   k = dt / 2m
template <class Real> struct Implicit {
  Real phi, kick;      // [-], eq. (3.13); dt / 2m [velocity/force]
  Real stay, share;    // 1 - phi, 1 / (1 + phi)

  static MDANIM_ALWAYS_INLINE Implicit of(const Real &phi, const Real &kick) { return {phi, kick, 1.0 - phi, 1.0 / (1.0 + phi)}; }
  MDANIM_ALWAYS_INLINE Vec<Real> first_half(const Vec<Real> &v, const Vec<Real> &f) const { return stay * v + kick * f; }
  MDANIM_ALWAYS_INLINE Vec<Real> final_half(const Vec<Real> &v, const Vec<Real> &f) const { return share * (v + kick * f); }

  // Energy that friction takes in the half step from va to vb. The first term is the work of F less the gain in kinetic energy,
  //   m (va + vb)/2 . (k F - (vb - va)) +- m phi k F . (2/3 h - 1/2 w),
  //   w = v^n, h = v^{n+-1/2}, + in the first half, - in the final.
  // The second is what the energy of the smooth path through the positions, which leap-frog conserves (fix_mdanim_leapfrog.cpp),
  // loses more: dt^2/6 times lambda F . G / m^2, G = F - lambda v, in a step by Euler and Maclaurin, dt^2/24 lambda v . F / m at
  // either end. Without it a vibration of frequency w would seem to lose (w dt)^2/6 less than it does.
  MDANIM_ALWAYS_INLINE Real loss(const Vec<Real> &va, const Vec<Real> &vb, const Vec<Real> &f, const Real &mass, bool first) const
  {
    const Vec<Real> push = kick * f, lag = first ? (2.0 / 3.0) * vb - 0.5 * va : 0.5 * vb - (2.0 / 3.0) * va;
    return mass * (0.5 * dot(va + vb, push - (vb - va)) + phi * dot(push, lag));
  }
  // Both halves of a step, from `first` v^{n-1/2} by `middle` v^n to `last` v^{n+1/2}. In each of them k F - (vb - va) is phi
  // v^n.
  MDANIM_ALWAYS_INLINE Real loss_of_step(const Vec<Real> &first, const Vec<Real> &middle, const Vec<Real> &last,
                                         const Vec<Real> &f, const Real &mass) const
  {
    const Vec<Real> push = kick * f;
    return mass * phi * (dot(middle, middle + 0.5 * (first + last)) + (2.0 / 3.0) * dot(push, last - first));
  }
};

// 2^-n for n >= 0, exactly; 0 below the normal range.
MDANIM_ALWAYS_INLINE double power_of_half(int n)
{
  if (n > 1022) return 0.0;
  const std::uint64_t bits = static_cast<std::uint64_t>(1023 - n) << 52;
  double value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

// e = exp(-phi) and g = (1 - e) / phi for phi >= 0, to 2 ulp, by + - * / alone: libm may round differently
// from one CPU to the next. phi = n ln2 + r with |r| <= ln2 / 2; then g(r) = sum (-r)^j / (j+1)! and exp(-r)
// = 1 - r g(r).
MDANIM_ALWAYS_INLINE void exponential_decay(double phi, double &e, double &g)
{
  if (!(phi < 700.0)) {    // exp(-phi) is negligible beside 1
    e = 0.0;
    g = 1.0 / phi;
    return;
  }
  constexpr double LN2_HIGH = 0x1.62e42feep-1,
                   LN2_LOW = 0x1.a39ef35793c76p-33;    // the high part times n is exact
  const int n = static_cast<int>(phi * 0x1.71547652b82fep+0 + 0.5);
  const double r = (phi - n * LN2_HIGH) - n * LN2_LOW;
  double series = 1.0;
  for (int j = 15; j >= 1; --j) series = 1.0 - series * r / (j + 1);
  e = (1.0 - r * series) * power_of_half(n);
  g = n == 0 ? series : (1.0 - e) / phi;
}

// Friction exact for a force that is constant over the half step: v <- e v + (1-e)/phi k F, e = exp(-phi), in
// both halves. Same terminal velocity as `Implicit`, no change of sign at phi > 1.
template <class Real> struct Exponential {
  Real e, push, kick;    // `push` is (1-e)/phi k

  static MDANIM_ALWAYS_INLINE Exponential of(const Real &phi, const Real &kick)
  {
    Real e{}, g{};
    if constexpr (std::is_same_v<Real, double>)
      exponential_decay(phi, e, g);
    else
      for (unsigned lane = 0; lane < sizeof(Real) / sizeof(double); ++lane) {
        double decay, mean;
        exponential_decay(phi[lane], decay, mean);
        e[lane] = decay, g[lane] = mean;
      }
    return {e, g * kick, kick};
  }
  MDANIM_ALWAYS_INLINE Vec<Real> first_half(const Vec<Real> &v, const Vec<Real> &f) const { return e * v + push * f; }
  MDANIM_ALWAYS_INLINE Vec<Real> final_half(const Vec<Real> &v, const Vec<Real> &f) const { return e * v + push * f; }

  // The work of F less the gain in kinetic energy, (va + vb)/2 . (F dt/2 - m (vb - va)): right for the velocities at any phi.
  MDANIM_ALWAYS_INLINE Real loss(const Vec<Real> &va, const Vec<Real> &vb, const Vec<Real> &f, const Real &mass, bool) const
  { return 0.5 * mass * dot(va + vb, kick * f - (vb - va)); }
  MDANIM_ALWAYS_INLINE Real loss_of_step(const Vec<Real> &first, const Vec<Real> &middle, const Vec<Real> &last,
                                         const Vec<Real> &f, const Real &mass) const
  { return loss(first, middle, f, mass, false) + loss(middle, last, f, mass, true); }
};

}    // namespace mdanim
