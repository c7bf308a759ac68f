// SPDX-License-Identifier: GPL-2.0-only
// The number type of the laws: a double, or a vector of doubles, one for each lane of a vector unit. Laws are templates over this
// `Real`, so plain styles and passes over blocks compute the same operations in the same order, hence the same bits.

#pragma once

#include <type_traits>

namespace mdanim {

// For all code that is also compiled for processors that not every host has (simd/of_set.h): a copy that is not inlined could be
// linked into the rest of the program.
#define MDANIM_ALWAYS_INLINE inline __attribute__((always_inline))

template <class Real> MDANIM_ALWAYS_INLINE Real root(Real a)
{
  if constexpr (std::is_same_v<Real, double>) {
    return __builtin_sqrt(a);
  } else {
    for (unsigned lane = 0; lane < sizeof(Real) / sizeof(double); ++lane) a[lane] = __builtin_sqrt(a[lane]);
    return a;
  }
}

template <class Real> MDANIM_ALWAYS_INLINE Real constant(double a) { return a - Real{}; }

// `a` in lanes in which a comparison is true, else `b`.
template <class Yes, class Real> MDANIM_ALWAYS_INLINE Real pick(const Yes &yes, const Real &a, const Real &b)
{ return yes ? a : b; }

template <class Real> MDANIM_ALWAYS_INLINE Real smaller(const Real &a, const Real &b) { return pick(b < a, b, a); }
template <class Real> MDANIM_ALWAYS_INLINE Real larger(const Real &a, const Real &b) { return pick(a < b, b, a); }

// Whether a comparison is true in at least one lane.
template <class Yes> MDANIM_ALWAYS_INLINE bool any(const Yes &yes)
{
  if constexpr (std::is_arithmetic_v<Yes>) {
    return yes;
  } else {
    constexpr unsigned LANES = sizeof(Yes) / sizeof(yes[0]);
    auto some = yes[0];
    for (unsigned lane = 1; lane < LANES; ++lane) some |= yes[lane];
    return some;
  }
}

}    // namespace mdanim
