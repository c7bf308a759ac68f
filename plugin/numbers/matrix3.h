// SPDX-License-Identifier: GPL-2.0-only
// Square matrices of three rows.

#pragma once

#include "numbers/vec3.h"

namespace mdanim {

struct Matrix3 {
  Vec3 row[3];
};

inline Vec3 operator*(const Matrix3 &m, const Vec3 &v) { return {dot(m.row[0], v), dot(m.row[1], v), dot(m.row[2], v)}; }

inline Matrix3 transposed(const Matrix3 &m)
{ return {{{m.row[0].x, m.row[1].x, m.row[2].x}, {m.row[0].y, m.row[1].y, m.row[2].y}, {m.row[0].z, m.row[1].z, m.row[2].z}}}; }

inline Matrix3 &operator+=(Matrix3 &m, const Matrix3 &other)
{
  for (int k = 0; k < 3; ++k) m.row[k] += other.row[k];
  return m;
}

inline Matrix3 operator+(Matrix3 m, const Matrix3 &other) { return m += other; }

inline Matrix3 operator*(double s, const Matrix3 &m) { return {{s * m.row[0], s * m.row[1], s * m.row[2]}}; }

inline Matrix3 operator*(const Matrix3 &m, const Matrix3 &other)
{
  const auto row = [&](const Vec3 &of) { return of.x * other.row[0] + of.y * other.row[1] + of.z * other.row[2]; };
  return {{row(m.row[0]), row(m.row[1]), row(m.row[2])}};
}

// a b^T.
inline Matrix3 outer(const Vec3 &a, const Vec3 &b) { return {{a.x * b, a.y * b, a.z * b}}; }

inline Matrix3 diagonal(double value) { return {{{value, 0.0, 0.0}, {0.0, value, 0.0}, {0.0, 0.0, value}}}; }

// Needs a determinant that is not 0.
inline Matrix3 inverse(const Matrix3 &m)
{
  const Vec3 a = cross(m.row[1], m.row[2]), b = cross(m.row[2], m.row[0]), c = cross(m.row[0], m.row[1]);
  return (1.0 / dot(m.row[0], a)) * transposed({{a, b, c}});
}

// The transpose of m, times v.
inline Vec3 transposed_times(const Matrix3 &m, const Vec3 &v)
{
  return {(m.row[0].x * v.x + m.row[1].x * v.y) + m.row[2].x * v.z, (m.row[0].y * v.x + m.row[1].y * v.y) + m.row[2].y * v.z,
          (m.row[0].z * v.x + m.row[1].z * v.y) + m.row[2].z * v.z};
}

}    // namespace mdanim
