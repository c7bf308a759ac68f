// SPDX-License-Identifier: GPL-2.0-only
// A vector that changes with time.

#pragma once

#include "numbers/vec3.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace mdanim {

// Straight from point to point,
//   a(t) = a_k + (a_{k+1} - a_k) (t - t_k) / (t_{k+1} - t_k),   t_k <= t < t_{k+1},
// the first value before the first point, the last one behind the last point. Times ascend.
class VectorPath {
 public:
  void append(double time, const Vec3 &a) { times.push_back(time), values.push_back(a); }
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

}    // namespace mdanim
