// SPDX-License-Identifier: GPL-2.0-only
// An acceleration that changes with time.

#pragma once

#include "numbers/vec3.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace mdanim {

// Straight from point to point,
//   g(t) = g_k + (g_{k+1} - g_k) (t - t_k) / (t_{k+1} - t_k),   t_k <= t < t_{k+1},
// the first value before the first point, the last one behind the last point. Times ascend.
class AccelerationPath {
 public:
  void append(double time, const Vec3 &g) { times.push_back(time), values.push_back(g); }
  bool empty() const { return times.empty(); }
  double last_time() const { return times.back(); }

  Vec3 at(double t) const
  {
    const std::size_t k = std::upper_bound(times.begin(), times.end(), t) - times.begin();    // points up to t
    if (k == 0) return values.front();
    if (k == times.size()) return values.back();
    const double part = (t - times[k - 1]) / (times[k] - times[k - 1]);
    return values[k - 1] + part * (values[k] - values[k - 1]);
  }

 private:
  std::vector<double> times;
  std::vector<Vec3> values;
};

// Work that an acceleration does on masses with the momentum P = sum of m v, from step to step:
//   W = sum_n dt (g_n + g_{n+1})/2 . P^{n+1/2},
// which is what leap-frog adds to the kinetic energy of v^n = (v^{n-1/2} + v^{n+1/2})/2, but for a sum that telescopes. Of masses
// that come or go between two steps nothing is counted but what they do while they are there.
class AccelerationWork {
 public:
  void begin(const Vec3 &g) { before = g; }
  // Goes to the next step, and returns g_n + g_{n+1}.
  Vec3 turn(const Vec3 &g)
  {
    const Vec3 both = before + g;
    before = g;
    return both;
  }
  // Adds the work of that step: `power` is (g_n + g_{n+1}) . P.
  void add(double power, double dt) { done += 0.5 * dt * power; }
  double total() const { return done; }

 private:
  Vec3 before;
  double done = 0.0;
};

}    // namespace mdanim
