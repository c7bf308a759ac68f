// SPDX-License-Identifier: GPL-2.0-only
// Vectors in space; sums are always taken as (x + y) + z, so that mirrored arguments give mirrored bits.

#pragma once

#include "numbers/real.h"

#include <cmath>

namespace mdanim {

// Three coordinates, each a double or one for each lane of a vector unit (real.h).
template <class Real> struct Vec {
  Real x{}, y{}, z{};

  MDANIM_ALWAYS_INLINE Vec &operator+=(const Vec &b)
  {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
  MDANIM_ALWAYS_INLINE Vec &operator-=(const Vec &b)
  {
    x -= b.x;
    y -= b.y;
    z -= b.z;
    return *this;
  }

  friend MDANIM_ALWAYS_INLINE Vec operator+(const Vec &a, const Vec &b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend MDANIM_ALWAYS_INLINE Vec operator-(const Vec &a, const Vec &b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend MDANIM_ALWAYS_INLINE Real dot(const Vec &a, const Vec &b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }
  friend MDANIM_ALWAYS_INLINE Vec cross(const Vec &a, const Vec &b)
  { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
  template <class Scalar> friend MDANIM_ALWAYS_INLINE Vec operator*(const Scalar &s, const Vec &a)
  { return {s * a.x, s * a.y, s * a.z}; }
};

using Vec3 = Vec<double>;

MDANIM_ALWAYS_INLINE double length(const Vec3 &a) { return std::sqrt(dot(a, a)); }
MDANIM_ALWAYS_INLINE Vec3 unit(const Vec3 &a) { return (1.0 / length(a)) * a; }

MDANIM_ALWAYS_INLINE Vec3 vec3(const double *a) { return {a[0], a[1], a[2]}; }
MDANIM_ALWAYS_INLINE void add_to(double *a, const Vec3 &b)
{
  a[0] += b.x;
  a[1] += b.y;
  a[2] += b.z;
}

}    // namespace mdanim
