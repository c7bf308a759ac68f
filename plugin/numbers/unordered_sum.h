// SPDX-License-Identifier: GPL-2.0-only
// Sums whose bits do not depend on the order of their terms: particles of a body may be spread over ranks in any way.

#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace mdanim {

// N sums side by side. Terms are taken as whole multiples of 2^-80 of a power of two that none of them exceeds, in two whole
// numbers of 2^40 each. Parts of the sums, each for some of the terms, are added number by number; they wrap around.
template <int N> struct UnorderedSums {
  std::array<std::uint64_t, N> high = {}, low = {};

  void add(const std::array<double, N> &terms, const std::array<double, N> &scale);
  double value(int k, double scale) const;
};

namespace unordered {

constexpr long MOST_TERMS = 1L << 22;       // neither whole number overflows
constexpr double UNIT = 1099511627776.0;    // 2^40
// The whole number next to x, |x| < 2^51, is what the bits of x + SHIFT have more than those of SHIFT.
constexpr double SHIFT = 6755399441055744.0;    // 1.5 * 2^52
constexpr std::uint64_t BITS_OF_SHIFT = 0x4338000000000000;

// Factor for terms of at most this magnitude. It is 0 for magnitudes below 2^-900, whose terms count as 0.
inline double scale_for(double largest)
{
  int exponent = 0;
  std::frexp(largest, &exponent);
  return largest > 0.0 && exponent > -900 ? std::ldexp(UNIT, -exponent) : 0.0;
}

}    // namespace unordered

// Loops of one operation each, for the vector unit.
template <int N> inline void UnorderedSums<N>::add(const std::array<double, N> &terms, const std::array<double, N> &scale)
{
  using namespace unordered;
  std::array<double, N> units, whole, rest;
  for (int k = 0; k < N; ++k) units[k] = terms[k] * scale[k];
  for (int k = 0; k < N; ++k) whole[k] = units[k] + SHIFT;
  for (int k = 0; k < N; ++k) rest[k] = (units[k] - (whole[k] - SHIFT)) * UNIT + SHIFT;
  std::array<std::uint64_t, N> bits_of_whole, bits_of_rest;
  std::memcpy(bits_of_whole.data(), whole.data(), sizeof whole);
  std::memcpy(bits_of_rest.data(), rest.data(), sizeof rest);
  for (int k = 0; k < N; ++k) high[k] += bits_of_whole[k] - BITS_OF_SHIFT;
  for (int k = 0; k < N; ++k) low[k] += bits_of_rest[k] - BITS_OF_SHIFT;
}

template <int N> inline double UnorderedSums<N>::value(int k, double scale) const
{
  const auto number = [](std::uint64_t bits) { return static_cast<double>(static_cast<std::int64_t>(bits)); };
  return scale > 0.0 ? (number(high[k]) + number(low[k]) / unordered::UNIT) / scale : 0.0;
}

}    // namespace mdanim
