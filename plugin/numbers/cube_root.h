// SPDX-License-Identifier: GPL-2.0-only
// A cube root of sums and products, with the same bits for a number and for each lane of a vector.

#pragma once

#include "numbers/real.h"

namespace mdanim {

// a^(-1/3) for a from 1e-300 to 1e300, to 1e-9 of it. The guess is right to 4 %: its upper 32 bits are GUESS minus a third of
// those of a. With r = 1 - a z^3 the root is z (1 - r)^(-1/3) = z (1 + r/3 + 2 r^2/9 + 14 r^3/81 +
// ...).
template <class Real> MDANIM_ALWAYS_INLINE Real inverse_cube_root(const Real &a)
{
  typedef long long Bits __attribute__((vector_size(sizeof(Real))));
  constexpr double BIG = 6755399441055744.0;    // 1.5 * 2^52: whole numbers are its last bits
  constexpr long long BITS_OF_BIG = 0x4338000000000000;
  constexpr double GUESS = 1430184263.0;
  const Bits upper = __builtin_bit_cast(Bits, a) >> 32;
  const Real exponent = __builtin_bit_cast(Real, upper + BITS_OF_BIG) - constant<Real>(BIG);
  const Real guess = (constant<Real>(GUESS) - exponent * constant<Real>(1.0 / 3.0)) + constant<Real>(BIG);
  Real z = __builtin_bit_cast(Real, __builtin_bit_cast(Bits, guess) << 32);
  const Real third = constant<Real>(1.0 / 3.0), one = constant<Real>(1.0);
  const Real r = one - a * ((z * z) * z), square = r * r;
  z = z + z * (r * third + square * (constant<Real>(2.0 / 9.0) + r * constant<Real>(14.0 / 81.0)));
  return z + z * ((one - a * ((z * z) * z)) * third);
}

}    // namespace mdanim
