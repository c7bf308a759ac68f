// SPDX-License-Identifier: GPL-2.0-only
// Turns counts of samples into codes of cells, in the boxes of cells that they touch or have touched.

#include "liquid/automaton/solid_cells.h"

#include <atomic>
#include <cstddef>

namespace mdanim {

SolidCells::SolidCells(int nx, int ny, int nz) : still(nx, ny, nz), mobile(nx, ny, nz), code(still.count.size(), OPEN) {}

long SolidCells::mark_still(const Add &add, const RankSums &ranks, const Threads &threads)
{
  const CellBox box = still.count_anew(add, ranks, threads);
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

void SolidCells::mark_moving(const Add &add, const RankSums &ranks, const Threads &threads)
{
  const CellBox box = mobile.count_anew(add, ranks, threads);
  constexpr double CELL = 1.0;    // [ns], approximately
  std::atomic<long> moving{0};
  box.each_row(threads, CELL, [&](int y, int z) {
    long of_row = 0;
    for (std::size_t c = mobile.number(box.low[0], y, z), end = mobile.number(box.high[0], y, z); c < end; ++c) {
      if (code[c] == STILL) continue;
      code[c] = 2 * (still.count[c] + mobile.count[c]) >= Occupancy::FULL ? MOVING : OPEN;
      of_row += code[c];
    }
    moving += of_row;
  });
  moving_cells = moving;
}

void SolidCells::assign(const std::vector<std::uint8_t> &codes)
{
  code = codes;
  mobile.clear(Threads());
  moving_cells = 0;
  for (int z = 0; z < mobile.nz; ++z)
    for (int y = 0; y < mobile.ny; ++y)
      for (int x = 0; x < mobile.nx; ++x) {
        const std::uint8_t now = code[mobile.number(x, y, z)];
        if (now == STILL) still.touched.take_in(x, y, z);
        if (now != MOVING) continue;
        mobile.touched.take_in(x, y, z);
        ++moving_cells;
      }
}

}    // namespace mdanim
