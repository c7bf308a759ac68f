// SPDX-License-Identifier: GPL-2.0-only
// Functions made of sums, products, quotients and square roots only: their bits are those of IEEE 754 on every processor. C
// libraries have other versions for processors with fused multiply-add, whose last bits differ.

#pragma once

#include <cmath>

namespace mdanim {

// sin(2 pi turns), to 4e-16.
inline double sine_of_turns(double turns)
{
  constexpr double TWO_PI = 6.283185307179586;
  double r = turns - std::floor(turns + 0.5);    // within 1/2
  if (r > 0.25) r = 0.5 - r;
  if (r < -0.25) r = -0.5 - r;
  const double x = TWO_PI * r, square = x * x;
  double sum = 1.0;
  for (int n = 22; n >= 2; n -= 2) sum = 1.0 - square / (n * (n + 1)) * sum;
  return x * sum;
}

// exp(-x) for x >= 0, to 1e-12 of its value: x is halved, and the exponential squared as often.
inline double decay(double x)
{
  constexpr double NOTHING = 740.0, SMALL = 0.25;
  if (!(x < NOTHING)) return 0.0;
  int halvings = 0;
  for (; x > SMALL; x *= 0.5) ++halvings;
  double value = 1.0;
  for (int n = 14; n >= 1; --n) value = 1.0 - x / n * value;
  while (halvings-- > 0) value *= value;
  return value;
}

inline double tangent_hyperbolic(double x)
{
  const double e = decay(2.0 * std::fabs(x)), value = (1.0 - e) / (1.0 + e);
  return x < 0.0 ? -value : value;
}

// x/sinh(x) for x >= 0.
inline double over_sine_hyperbolic(double x)
{
  constexpr double SMALL = 1e-4;
  if (x < SMALL) return 1.0 - x * x / 6.0;
  const double e = decay(x);
  return 2.0 * x * e / (1.0 - e * e);
}

// The angle of (x, y), from -pi to pi, to 4e-16; 0 for (0, 0). Tangents of half of it, of a quarter and so on: a series of the
// last.
inline double angle_of(double y, double x)
{
  constexpr double PI = 3.141592653589793;
  const double length = std::sqrt(x * x + y * y), along = std::fabs(x);
  if (!(length > 0.0)) return 0.0;
  double t = y / (length + along);
  t = t / (1.0 + std::sqrt(1.0 + t * t));
  t = t / (1.0 + std::sqrt(1.0 + t * t));    // at most tan(pi/16)
  const double square = t * t;
  double sum = 0.0;
  for (int n = 23; n >= 1; n -= 2) sum = 1.0 / n - square * sum;
  const double angle = 8.0 * t * sum;
  if (x >= 0.0) return angle;
  return y < 0.0 ? -PI - angle : PI - angle;
}

}    // namespace mdanim
