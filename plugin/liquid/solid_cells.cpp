// SPDX-License-Identifier: GPL-2.0-only
// Counts of samples to codes of cells, in the boxes of cells that they touch or have touched.

#include "liquid/solid_cells.h"

#include <cstddef>

namespace mdanim {

SolidCells::SolidCells(int nx, int ny, int nz) : still(nx, ny, nz), mobile(nx, ny, nz), code(still.count.size(), OPEN) {}

long SolidCells::mark_still(const Add &add, const RankSums &ranks)
{
  CellBox box = still.touched;
  still.clear();
  add(still);
  still.sum_over(ranks);
  box.take_in(still.touched);
  long changed = 0;
  box.each([&](int x, int y, int z) {
    const std::size_t c = still.number(x, y, z);
    const bool filled = 2 * still.count[c] >= Occupancy::FULL;
    if (filled == (code[c] == STILL)) return;
    code[c] = filled ? STILL : OPEN;
    ++changed;
  });
  return changed;
}

void SolidCells::mark_moving(const Add &add, const RankSums &ranks)
{
  CellBox box = mobile.touched;
  mobile.clear();
  add(mobile);
  mobile.sum_over(ranks);
  box.take_in(mobile.touched);
  moving_cells = 0;
  box.each([&](int x, int y, int z) {
    const std::size_t c = mobile.number(x, y, z);
    if (code[c] == STILL) return;
    code[c] = 2 * (still.count[c] + mobile.count[c]) >= Occupancy::FULL ? MOVING : OPEN;
    moving_cells += code[c];
  });
}

void SolidCells::assign(const std::vector<std::uint8_t> &codes)
{
  code = codes;
  mobile.clear();
  moving_cells = 0;
  for (int z = 0; z < mobile.nz; ++z)
    for (int y = 0; y < mobile.ny; ++y)
      for (int x = 0; x < mobile.nx; ++x) {
        if (code[mobile.number(x, y, z)] != MOVING) continue;
        mobile.touched.take_in(x, y, z);
        ++moving_cells;
      }
}

}    // namespace mdanim
