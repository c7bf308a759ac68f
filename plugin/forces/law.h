// SPDX-License-Identifier: GPL-2.0-only
// Forces and torques on objects as a whole, in windows of time.

#pragma once

#include "numbers/matrix3.h"
#include "rigid/inertia.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace mdanim {

// A force and a torque that act from one time to another.
struct ForceWindow {
  Vec3 force, torque;
  double from = -std::numeric_limits<double>::infinity(), to = std::numeric_limits<double>::infinity();

  // The part of the time that the kicks of step n stand for, from half a step before t_n = n dt to half a step behind it, that is
  // in the window; step 0 has the second half alone. So all kicks together give the force times the length of the window:
  //   sum_n w_n dt = to - from
  double part(long long step, double dt) const
  {
    const double begin = step > 0 ? (static_cast<double>(step) - 0.5) * dt : 0.0, end = (static_cast<double>(step) + 0.5) * dt;
    if (from <= begin && to >= end) return 1.0;
    return std::max(0.0, std::min(to, end) - std::max(from, begin)) / (end - begin);
  }
};

// All forces on one object.
struct ForceWindows {
  std::vector<ForceWindow> all;

  ForceWindow at(long long step, double dt) const
  {
    ForceWindow sum;
    for (const ForceWindow &one : all) {
      const double part = one.part(step, dt);
      sum.force += part * one.force;
      sum.torque += part * one.torque;
    }
    return sum;
  }
  bool turns() const
  {
    return std::any_of(all.begin(), all.end(), [](const ForceWindow &one) { return dot(one.torque, one.torque) > 0.0; });
  }
  double last() const
  {
    double last = -std::numeric_limits<double>::infinity();
    for (const ForceWindow &one : all) last = std::max(last, one.to);
    return last;
  }
};

// An object's acceleration and angular acceleration by a force and a torque,
//   a = F / M,   alpha = I^-1 T,
// which its particles share as f_i = m_i (a + alpha x (x_i - c)): their sum is F, that of their torques about c is T.
struct WholePush {
  Vec3 a, alpha, centre;

  Vec3 on(double mass, const Vec3 &x) const { return mass * (a + cross(alpha, x - centre)); }
  // sum f_i d_i for particles that go ways d, with sum m d, and sum m (x - about) x d.
  double work(const Vec3 &way, const Vec3 &swept, const Vec3 &about) const
  { return dot(a, way) + dot(alpha, swept + cross(about - centre, way)); }
};

inline Matrix3 matrix(const Inertia &of) { return {{{of.xx, of.xy, of.xz}, {of.xy, of.yy, of.yz}, {of.xz, of.yz, of.zz}}}; }

// Whether moments are those of points that do not stand on a line, whose moment about it is 0.
inline bool has_volume(const Inertia &of)
{
  constexpr double THIN = 1e-10;
  const Matrix3 m = matrix(of);
  const double trace = of.xx + of.yy + of.zz;
  return dot(m.row[0], cross(m.row[1], m.row[2])) > THIN * trace * trace * trace;
}

}    // namespace mdanim
