// SPDX-License-Identifier: GPL-2.0-only
// Sums whose bits do not depend on the order of their terms: particles of a body may be spread over ranks in any way.

#pragma once

#include <cmath>
#include <cstdint>

namespace mdanim {

// Terms are taken as whole multiples of 2^-80 of a power of two that none of them exceeds. Parts of a sum, each for some of the
// terms, are added as two whole numbers.
struct UnorderedSum {
  static constexpr long MOST_TERMS = 1L << 22;       // neither whole number overflows
  static constexpr double UNIT = 1099511627776.0;    // 2^40

  // Factor for terms of at most this magnitude. It is 0 for magnitudes below 2^-900, whose terms count as 0.
  static double scale_for(double largest)
  {
    int exponent = 0;
    std::frexp(largest, &exponent);
    return largest > 0.0 && exponent > -900 ? std::ldexp(UNIT, -exponent) : 0.0;
  }

  void add(double term, double scale)
  {
    const double units = term * scale, whole = nearest(units);
    high += static_cast<std::int64_t>(whole);
    low += static_cast<std::int64_t>(nearest((units - whole) * UNIT));
  }
  double value(double scale) const
  { return scale > 0.0 ? (static_cast<double>(high) + static_cast<double>(low) / UNIT) / scale : 0.0; }

  std::int64_t high = 0, low = 0;

 private:
  static double nearest(double x)    // whole number, for |x| < 2^51
  {
    constexpr double SHIFT = 6755399441055744.0;    // 1.5 * 2^52
    return (x + SHIFT) - SHIFT;
  }
};

}    // namespace mdanim
