// SPDX-License-Identifier: GPL-2.0-only
// Layers are kept apart by a push between the nearest points of two features.

#pragma once

#include "numbers/vec3.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

// Points of two features that are nearest to each other, as weights of their corners, which sum to 1.
struct NearestPoints {
  double own[2] = {1.0, 0.0};
  double other[3] = {1.0, 0.0, 0.0};
};

// The point of a triangle that is nearest to p (Ericson, Real-Time Collision Detection, 2005).
inline NearestPoints foot_on_triangle(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c)
{
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {{1.0, 0.0}, {1.0, 0.0, 0.0}};
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return {{1.0, 0.0}, {0.0, 1.0, 0.0}};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) {
    const double v = d1 / (d1 - d3);
    return {{1.0, 0.0}, {1.0 - v, v, 0.0}};
  }
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return {{1.0, 0.0}, {0.0, 0.0, 1.0}};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) {
    const double w = d2 / (d2 - d6);
    return {{1.0, 0.0}, {1.0 - w, 0.0, w}};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {{1.0, 0.0}, {0.0, 1.0 - w, w}};
  }
  const double all = (va + vb) + vc;
  const double v = vb / all, w = vc / all;
  return {{1.0, 0.0}, {(1.0 - v) - w, v, w}};
}

inline double in_unit(double t) { return std::max(0.0, std::min(1.0, t)); }

// The point of a segment that is nearest to p.
inline NearestPoints foot_on_segment(const Vec3 &p, const Vec3 &a, const Vec3 &b)
{
  const Vec3 ab = b - a;
  const double square = dot(ab, ab), t = square > 0.0 ? in_unit(dot(p - a, ab) / square) : 0.0;
  return {{1.0, 0.0}, {1.0 - t, t, 0.0}};
}

// The points of two segments, from p to q and from a to b, that are nearest to each other.
inline NearestPoints feet_of_segments(const Vec3 &p, const Vec3 &q, const Vec3 &a, const Vec3 &b)
{
  const Vec3 u = q - p, v = b - a, r = p - a;
  const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), ur = dot(u, r), vr = dot(v, r);
  const double both = uu * vv - uv * uv;
  double s = both > 0.0 ? in_unit((uv * vr - ur * vv) / both) : 0.0;
  double t = vv > 0.0 ? (uv * s + vr) / vv : 0.0;
  if (t < 0.0 || t > 1.0) {
    t = in_unit(t);
    s = uu > 0.0 ? in_unit((uv * t - ur) / uu) : 0.0;
  }
  return {{1.0 - s, s}, {1.0 - t, t, 0.0}};
}

// The law of a pair of objects. With the distance d of the nearest points, the depth delta = reach - d and eps = ONSET reach:
//   U = k g(delta),   g = delta^3/6 eps for delta < eps, else (delta - eps/2)^2/2 + eps^2/24
// along the line between both; a dashpot along it, -c v_n, so that they never pull; and friction mu N against the velocity
// across. Neither takes more than MOST of the velocity of the mass m that moves in a step, so that an explicit step is stable.
struct FoldLaw {
  static constexpr double ONSET = 0.2, MOST = 0.25;

  double reach, stiffness;
  double friction = 0.0;
  double damping = 0.0;    // c over 2 sqrt(k m)

  struct FoldPush {
    double energy = 0.0, force = 0.0;    // along the line
  };
  FoldPush push(double distance) const
  {
    const double depth = reach - distance, onset = ONSET * reach;
    if (depth <= 0.0) return {};
    if (depth < onset)
      return {stiffness * ((depth * depth) * depth) / (6.0 * onset), stiffness * (depth * depth) / (2.0 * onset)};
    const double past = depth - 0.5 * onset;
    return {stiffness * (0.5 * (past * past) + (onset * onset) / 24.0), stiffness * past};
  }
  // The dashpot's force along the line, beside the push: velocity is positive where they part.
  double dashpot(double distance, double push, double velocity, double mass, double dt) const
  {
    const double grown = in_unit((reach - distance) / (ONSET * reach));
    const double c = std::min(2.0 * damping * std::sqrt(stiffness * mass), MOST * mass / dt) * grown;
    return std::max(-push, -c * velocity);
  }
  // Friction's force over the velocity across, whose size this is.
  double rub(double normal, double speed, double mass, double dt) const
  { return speed > 0.0 ? -std::min(friction * normal / speed, MOST * mass / dt) : 0.0; }
};

}    // namespace mdanim
