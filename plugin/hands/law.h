// SPDX-License-Identifier: GPL-2.0-only
// A hand: a spring and a dashpot from a material point of an object to a place that moves.

#pragma once

#include "numbers/vec3.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace mdanim {

struct HandKey {
  double time;
  Vec3 at;
};

struct HandMotion {
  Vec3 at, velocity;
};

// With the place p and velocity v of the material point, and those of the hand, a and u,
//   F = k (a - p) + c (u - v),  no larger than `most`.
// The material point is a sum over particles, p = sum w_i x_i with sum w_i = 1, and they share the force as f_i = w_i F: power
// and momentum are those of F at p.
struct Hand {
  double stiffness = 0.0, damping = 0.0, most = 0.0;
  std::vector<std::int64_t> tags;
  std::vector<double> weights;
  std::vector<HandKey> keys;    // ascending

  // Where it is in step n, at t = n dt: straight from key to key. It holds on from the step behind its first key up to the one at
  // its last key, so a key that is added at the end of a run changes nothing that has been.
  std::optional<HandMotion> at(long long step, double dt) const
  {
    const double now = static_cast<double>(step) * dt, half = 0.5 * dt;
    if (keys.size() < 2 || now <= keys.front().time + half || now > keys.back().time + half) return std::nullopt;
    const auto behind = std::find_if(keys.begin() + 1, keys.end(), [&](const HandKey &key) { return now <= key.time + half; });
    const HandKey &from = *(behind - 1), &to = *behind;
    const double lasts = to.time - from.time, part = std::clamp((now - from.time) / lasts, 0.0, 1.0);
    return HandMotion{from.at + part * (to.at - from.at), (1.0 / lasts) * (to.at - from.at)};
  }
  // Whether it neither acts in a step nor did in the one before, nor will.
  bool is_over(long long step, double dt) const
  { return keys.empty() || (static_cast<double>(step) - 1.5) * dt > keys.back().time; }

  Vec3 force(const HandMotion &hand, const Vec3 &place, const Vec3 &velocity) const
  {
    const Vec3 all = stiffness * (hand.at - place) + damping * (hand.velocity - velocity);
    const double size = length(all);
    return size > most ? (most / size) * all : all;
  }
};

}    // namespace mdanim
