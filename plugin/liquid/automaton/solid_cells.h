// SPDX-License-Identifier: GPL-2.0-only
// The cells of a basin that solids fill.

#pragma once

#include "liquid/occupancy.h"
#include "liquid/rank_sums.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace mdanim {

// Cells at least half filled by bodies of all ranks. Bodies that never move are counted separately, and seldom.
class SolidCells {
 public:
  enum Code : std::uint8_t { OPEN = 0, MOVING = 1, STILL = 2 };    // the codes of Automaton::displace
  // Adds this rank's bodies to the counts.
  using Add = std::function<void(Occupancy &)>;

  SolidCells(int nx, int ny, int nz);

  // Marks bodies that never move; returns the number of cells that this changes.
  long mark_still(const Add &add, const RankSums &ranks, const Threads &threads);
  // Marks all other bodies.
  void mark_moving(const Add &add, const RankSums &ranks, const Threads &threads);
  // Sets codes of all cells, x fastest; counts are forgotten.
  void assign(const std::vector<std::uint8_t> &codes);

  const std::vector<std::uint8_t> &codes() const { return code; }
  long moving() const { return moving_cells; }
  double bytes() const { return static_cast<double>(code.size()) * (1.0 + 2.0 * sizeof(int)); }

 private:
  Occupancy still, mobile;
  std::vector<std::uint8_t> code;
  long moving_cells = 0;
};

}    // namespace mdanim
