// SPDX-License-Identifier: GPL-2.0-only
// Wall time of one style: LAMMPS lumps all fixes into one line of its timing.

#pragma once

#include <chrono>

namespace mdanim {

// Adds the lifetime of the object to `seconds`.
class Lap {
 public:
  explicit Lap(double &seconds) : seconds(seconds), start(Clock::now()) {}
  ~Lap() { seconds += std::chrono::duration<double>(Clock::now() - start).count(); }
  Lap(const Lap &) = delete;
  Lap &operator=(const Lap &) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double &seconds;
  Clock::time_point start;
};

}    // namespace mdanim
