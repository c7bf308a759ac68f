// SPDX-License-Identifier: GPL-2.0-only
// Three doubles; sums are always taken as (x + y) + z, so that mirrored arguments give mirrored bits.

#ifndef MDANIM_VEC3_H
#define MDANIM_VEC3_H

namespace mdanim {

struct Vec3 {
  double x = 0.0, y = 0.0, z = 0.0;

  Vec3 &operator+=(const Vec3 &b)
  {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
  Vec3 &operator-=(const Vec3 &b)
  {
    x -= b.x;
    y -= b.y;
    z -= b.z;
    return *this;
  }
};

inline Vec3 operator+(const Vec3 &a, const Vec3 &b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(const Vec3 &a, const Vec3 &b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator*(double s, const Vec3 &a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(const Vec3 &a, const Vec3 &b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }
inline Vec3 cross(const Vec3 &a, const Vec3 &b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline Vec3 vec3(const double *a) { return {a[0], a[1], a[2]}; }
inline void add_to(double *a, const Vec3 &b)
{
  a[0] += b.x;
  a[1] += b.y;
  a[2] += b.z;
}

}    // namespace mdanim

#endif
