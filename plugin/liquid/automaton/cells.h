// SPDX-License-Identifier: GPL-2.0-only
// The automaton's grid (Wcislo 1999, sec. 4): whole numbers of liquid in cubic cells, some of which are solid.

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mdanim {

// nx x ny x nz cells with a rim of solid cells all around, so that neighbours need no test of bounds.
// Rows run along x; `row` is even, so that pairs of cells lie alike in every row.
struct Cells {
  static constexpr std::uint8_t OPEN = 0xff, SOLID = 0;    // of `open`: masks for vectors of bytes
  static constexpr int FULLEST = 250;                      // most that a cell may hold

  Cells(int nx, int ny, int nz)
      : nx(nx), ny(ny), nz(nz), row((nx + 3) & ~1), layer(static_cast<std::size_t>(row) * (ny + 2)), content(layer * (nz + 2), 0),
        open(layer * (nz + 2), SOLID), still(layer * (nz + 2), 1)
  {
    for (int z = 0; z < nz; ++z)
      for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x) {
          open[at(x, y, z)] = OPEN;
          still[at(x, y, z)] = 0;
        }
  }

  // Place of a cell in the arrays; -1 and n are the rim.
  std::size_t at(int x, int y, int z) const { return (z + 1) * layer + static_cast<std::size_t>(y + 1) * row + (x + 1); }
  // Its number among the cells without the rim, which keys draws.
  std::uint64_t number(int x, int y, int z) const { return (static_cast<std::uint64_t>(z) * ny + y) * nx + x; }

  // Calls f(x, y, z) for all cells in the order of their numbers.
  template <class F> void each(F &&f) const
  {
    for (int z = 0; z < nz; ++z)
      for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x) f(x, y, z);
  }

  int nx, ny, nz;
  int row;
  std::size_t layer;
  std::vector<std::uint8_t> content;    // 0 none, 1 at rest pressure, more under pressure; always 0 in solid cells
  std::vector<std::uint8_t> open;       // OPEN or SOLID
  std::vector<std::uint8_t> still;      // 1 where the solid in the cell never moves (held objects, the rim), else 0
};

}    // namespace mdanim
