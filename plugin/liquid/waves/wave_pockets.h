// SPDX-License-Identifier: GPL-2.0-only
// Liquid that is shut in: its pressure is known but for a number that nothing in the system of heads tells.

#pragma once

#include "liquid/waves/wave_columns.h"

#include <cstdint>
#include <vector>

namespace mdanim {

// Full spans below held roofs that are joined with each other and with nothing else.
class WavePockets {
 public:
  explicit WavePockets(WaveColumns &columns) : columns(columns) {}

  // Takes the mean off the changes of heads of each pocket, in the solver's x: else what a preconditioner adds to all of them
  // alike grows from update to update.
  void level();

 private:
  bool find();    // whether there may be some
  void join(long a, long b, double couple);
  long first_of(long i);

  WaveColumns &columns;
  std::vector<long> before;    // of each place: one before it in its pocket, itself for the first, -1 outside
  std::vector<std::uint8_t> is_open;
  std::vector<double> sum;
  std::vector<int> count;
};

}    // namespace mdanim
