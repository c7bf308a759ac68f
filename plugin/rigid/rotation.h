// SPDX-License-Identifier: GPL-2.0-only
// Rotations as unit quaternions, and the free rotation of a rigid body, by + - * / and square roots alone.

#pragma once

#include "numbers/matrix3.h"
#include "numbers/vec3.h"

#include <cmath>

namespace mdanim {

struct Quaternion {
  double w = 1.0, x = 0.0, y = 0.0, z = 0.0;
};

// First rotates by b, then by a.
inline Quaternion operator*(const Quaternion &a, const Quaternion &b)
{
  return {(a.w * b.w - a.x * b.x) - (a.y * b.y + a.z * b.z), (a.w * b.x + a.x * b.w) + (a.y * b.z - a.z * b.y),
          (a.w * b.y + a.y * b.w) + (a.z * b.x - a.x * b.z), (a.w * b.z + a.z * b.w) + (a.x * b.y - a.y * b.x)};
}

inline Quaternion unit(const Quaternion &q)
{
  const double s = 1.0 / std::sqrt((q.w * q.w + q.x * q.x) + (q.y * q.y + q.z * q.z));
  return {s * q.w, s * q.x, s * q.y, s * q.z};
}

// Its columns are the axes of the body in space.
inline Matrix3 matrix(const Quaternion &q)
{
  const double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z, wx = q.w * q.x,
               wy = q.w * q.y, wz = q.w * q.z;
  return {{{1.0 - 2.0 * (yy + zz), 2.0 * (xy - wz), 2.0 * (xz + wy)},
           {2.0 * (xy + wz), 1.0 - 2.0 * (xx + zz), 2.0 * (yz - wx)},
           {2.0 * (xz - wy), 2.0 * (yz + wx), 1.0 - 2.0 * (xx + yy)}}};
}

// The rotation of a matrix with determinant 1, from the largest of the four sums that are squares of its numbers.
inline Quaternion quaternion(const Matrix3 &m)
{
  const double xx = m.row[0].x, yy = m.row[1].y, zz = m.row[2].z;
  const double x = m.row[2].y - m.row[1].z, y = m.row[0].z - m.row[2].x, z = m.row[1].x - m.row[0].y;    // 4 w (x, y, z)
  const double xy = m.row[1].x + m.row[0].y, xz = m.row[0].z + m.row[2].x, yz = m.row[2].y + m.row[1].z;
  if (const double w = 1.0 + xx + yy + zz; w >= 1.0) return unit({w, x, y, z});
  if (xx >= yy && xx >= zz) return unit({x, 1.0 + xx - yy - zz, xy, xz});
  if (yy >= zz) return unit({y, xy, 1.0 - xx + yy - zz, yz});
  return unit({z, xz, yz, 1.0 - xx - yy + zz});
}

// tan(a)/a by its series, from a^2; to 1e-10 for angles up to 0.1. The map below is symplectic for any such function, since each
// part of it is the exact flow of some function of one component of the angular momentum; accuracy alone depends on it.
inline double tangent_ratio(double square)
{ return 1.0 + square * (1.0 / 3.0 + square * (2.0 / 15.0 + square * (17.0 / 315.0 + square * (62.0 / 2835.0)))); }

namespace rotation {

inline double &component(Vec3 &v, int k) { return k == 0 ? v.x : k == 1 ? v.y : v.z; }

// Turns the body by twice `half_angle` about its own axis k; `body` is the angular momentum along its axes.
inline void about_own_axis(Quaternion &q, Vec3 &body, int k, double half_angle)
{
  const double t = half_angle * tangent_ratio(half_angle * half_angle), share = 1.0 / (1.0 + t * t), c = (1.0 - t * t) * share,
               s = 2.0 * t * share;
  double &next = component(body, (k + 1) % 3), &last = component(body, (k + 2) % 3);
  const double before = next;
  next = c * before + s * last;
  last = c * last - s * before;
  Vec3 axis;
  component(axis, k) = t;
  q = q * Quaternion{1.0, axis.x, axis.y, axis.z};
}

// Turns the body by twice the length of `half_angle` about it, an axis in space.
inline void about_axis(Quaternion &q, const Vec3 &half_angle)
{
  const Vec3 t = tangent_ratio(dot(half_angle, half_angle)) * half_angle;
  q = Quaternion{1.0, t.x, t.y, t.z} * q;
}

}    // namespace rotation

// Free rotation for dt of a body with angular momentum L in space, which stays; `over` is 1/I about its principal axes.
//   H = sum L_k^2 / 2 I_k is split into its three terms, each a rotation about one axis: x/2, y/2, z, y/2, x/2 (Strang),
// which is of second order, symplectic and reversible. A body with two or three equal moments is turned exactly but for the
// series of the tangent: about L, then about its axis of symmetry.
inline void rotate_freely(Quaternion &q, const Vec3 &L, const Vec3 &over, double dt)
{
  using namespace rotation;
  const double h = 0.5 * dt;
  Vec3 body = transposed_times(matrix(q), L), rates = over;
  for (int k = 0; k < 3; ++k) {    // k: the axis of symmetry
    const double across = component(rates, (k + 1) % 3);
    if (across != component(rates, (k + 2) % 3)) continue;
    about_axis(q, (h * across) * L);
    about_own_axis(q, body, k, h * (component(rates, k) - across) * component(body, k));
    q = unit(q);
    return;
  }
  about_own_axis(q, body, 0, 0.5 * h * over.x * body.x);
  about_own_axis(q, body, 1, 0.5 * h * over.y * body.y);
  about_own_axis(q, body, 2, h * over.z * body.z);
  about_own_axis(q, body, 1, 0.5 * h * over.y * body.y);
  about_own_axis(q, body, 0, 0.5 * h * over.x * body.x);
  q = unit(q);
}

}    // namespace mdanim
