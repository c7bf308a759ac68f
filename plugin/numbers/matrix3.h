// SPDX-License-Identifier: GPL-2.0-only
// Square matrices of three rows.

#pragma once

#include "numbers/vec3.h"

namespace mdanim {

struct Matrix3 {
  Vec3 row[3];
};

inline Vec3 operator*(const Matrix3 &m, const Vec3 &v) { return {dot(m.row[0], v), dot(m.row[1], v), dot(m.row[2], v)}; }

// The transpose of m, times v.
inline Vec3 transposed_times(const Matrix3 &m, const Vec3 &v)
{
  return {(m.row[0].x * v.x + m.row[1].x * v.y) + m.row[2].x * v.z, (m.row[0].y * v.x + m.row[1].y * v.y) + m.row[2].y * v.z,
          (m.row[0].z * v.x + m.row[1].z * v.y) + m.row[2].z * v.z};
}

}    // namespace mdanim
