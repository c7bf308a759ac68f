// SPDX-License-Identifier: GPL-2.0-only
// The motion of what is held and driven: a rigid map of its places at the start, a function of time by + - * / and square roots
// alone. Its bits are the same on every processor and in any sequence of runs.

#pragma once

#include "numbers/portable.h"
#include "numbers/vec3.h"
#include "rigid/rotation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace mdanim {

// x(t) = to + turn (x(0) - from)
struct DrivenPlace {
  Quaternion q;
  Matrix3 turn{{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};    // matrix(q)
  Vec3 from, to;

  Vec3 of(const Vec3 &start) const { return to + turn * (start - from); }
};

// The map from one place of what is driven to another, which is near it.
struct DrivenStep {
  DrivenStep(const DrivenPlace &a, const DrivenPlace &b)
      : a(a), b(b), turned(b.q * Quaternion{a.q.w, -a.q.x, -a.q.y, -a.q.z}),
        angle((turned.w < 0.0 ? -2.0 : 2.0) * Vec3{turned.x, turned.y, turned.z})
  {
  }
  Vec3 of(const Vec3 &there) const { return b.of(a.from + transposed_times(a.turn, there - a.to)); }

  const DrivenPlace &a, &b;
  const Quaternion turned;
  const Vec3 angle;    // rotation vector
};

// A rotation by the length of a vector about it.
inline Quaternion rotation_by(const Vec3 &angle)
{
  constexpr double FOUR_PI = 12.566370614359172;
  const double size = length(angle);
  if (size == 0.0) return {};
  const double half = size / FOUR_PI, s = sine_of_turns(half) / size;    // `half` in turns
  return unit({sine_of_turns(half + 0.25), s * angle.x, s * angle.y, s * angle.z});
}

// The one next to 0 of two numbers of the same sign, else 0.
inline double least(double a, double b) { return std::max(std::min(a, b), 0.0) + std::min(std::max(a, b), 0.0); }
inline Vec3 least(const Vec3 &a, const Vec3 &b) { return {least(a.x, b.x), least(a.y, b.y), least(a.z, b.z)}; }

// A path through keys: between two of them a cubic curve, each component of which is monotone (Fritsch and Carlson 1980). Its
// slopes are those of the neighbours, but no more than three times that to either of them:
//   m_ij = (p_j - p_i) / (t_j - t_i),   p'_k = least(m_{k-1,k+1}, 3 least(m_{k-1,k}, m_{k,k+1})),   0 at both ends;
// at rest at the first key before it, and at the last one behind it. Times ascend.
class KeyPath {
 public:
  struct Key {
    double time;
    Vec3 way, angle;    // displacement, and rotation vector, from the start
  };

  void append(const Key &key) { keys.push_back(key); }
  bool empty() const { return keys.empty(); }
  bool turns() const
  {
    return std::any_of(keys.begin(), keys.end(),
                       [](const Key &key) { return key.angle.x != 0.0 || key.angle.y != 0.0 || key.angle.z != 0.0; });
  }
  double last_time() const { return keys.back().time; }

  Key at(double t) const
  {
    const std::size_t k =
        std::upper_bound(keys.begin(), keys.end(), t, [](double now, const Key &key) { return now < key.time; }) -
        keys.begin();    // keys up to t
    if (k == 0) return keys.front();
    if (k == keys.size()) return keys.back();
    const Key &a = keys[k - 1], &b = keys[k];
    const double h = b.time - a.time, s = (t - a.time) / h, r = 1.0 - s;
    const double of_b = s * s * (3.0 - 2.0 * s), slope_a = s * (r * r) * h, slope_b = -(s * s) * r * h;
    const auto along = [&](Vec3 Key::*what) {
      return a.*what + (of_b * (b.*what - a.*what) + (slope_a * slope(k - 1, what) + slope_b * slope(k, what)));
    };
    return {t, along(&Key::way), along(&Key::angle)};
  }

 private:
  Vec3 slope(std::size_t k, Vec3 Key::*what) const
  {
    if (k == 0 || k + 1 == keys.size()) return {};
    return least(mean(k - 1, k + 1, what), 3.0 * least(mean(k - 1, k, what), mean(k, k + 1, what)));
  }
  Vec3 mean(std::size_t i, std::size_t j, Vec3 Key::*what) const
  { return (1.0 / (keys[j].time - keys[i].time)) * (keys[j].*what - keys[i].*what); }

  std::vector<Key> keys;
};

struct Oscillation {
  Vec3 way;
  double frequency = 0.0, phase = 0.0;    // phase in turns
};

// Displacements add up:  D = v t + sum_n d_n (sin(2 pi (f_n t + phase_n)) - sin(2 pi phase_n))
// Keys turn about `pivot` and move it by s; the turn by w t is about `centre`:
//   x = centre + D + R(w t) (pivot + s + R(angle) (x(0) - pivot) - centre)
struct DrivenMotion {
  Vec3 velocity;
  Vec3 turn, centre;    // angular velocity, and the point about which it turns
  std::vector<Oscillation> oscillations;
  KeyPath path;
  Vec3 pivot;
  double until = std::numeric_limits<double>::infinity();    // time at which it is released

  bool turns() const { return turn.x != 0.0 || turn.y != 0.0 || turn.z != 0.0 || path.turns(); }
  // The last step that it takes: the one next to `until`.
  double last_step(double dt) const { return std::floor(until / dt + 0.5); }

  DrivenPlace at(double t) const
  {
    DrivenPlace now;
    now.to = t * velocity;
    for (const Oscillation &one : oscillations)
      now.to += (sine_of_turns(one.frequency * t + one.phase) - sine_of_turns(one.phase)) * one.way;
    const bool turns = turn.x != 0.0 || turn.y != 0.0 || turn.z != 0.0;
    KeyPath::Key key{};
    if (!path.empty()) key = path.at(t);
    if (!turns && path.empty()) return now;    // a displacement alone
    now.from = path.empty() ? centre : pivot;
    const Quaternion q = rotation_by(t * turn);
    now.to += turns ? centre + matrix(q) * (now.from + key.way - centre) : now.from + key.way;
    now.q = q * rotation_by(key.angle);
    now.turn = matrix(now.q);
    return now;
  }
};

}    // namespace mdanim
