// SPDX-License-Identifier: GPL-2.0-only
// Boxes of cells.

#pragma once

#include "threads/team.h"

#include <algorithm>
#include <cstddef>

namespace mdanim {

// A box of cells, [low, high) along each axis; empty at first.
struct CellBox {
  int low[3] = {1 << 30, 1 << 30, 1 << 30}, high[3] = {0, 0, 0};
  bool empty() const { return low[0] >= high[0]; }
  void take_in(int x, int y, int z)
  {
    const int at[3] = {x, y, z};
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], at[d]);
      high[d] = std::max(high[d], at[d] + 1);
    }
  }
  void take_in(const CellBox &other)
  {
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], other.low[d]);
      high[d] = std::max(high[d], other.high[d]);
    }
  }
  std::size_t size() const
  {
    if (empty()) return 0;
    return static_cast<std::size_t>(high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]);
  }
  // Calls f(y, z) for rows of its cells, shared among threads; a cell takes about `ns` nanoseconds.
  template <class F> void each_row(const Threads &threads, double ns, const F &f) const
  {
    if (empty()) return;
    const long deep = high[1] - low[1], many = deep * (high[2] - low[2]);
    threads.parts(many, ns * (high[0] - low[0]), [&](long from, long to) {
      for (long n = from; n < to; ++n) f(low[1] + static_cast<int>(n % deep), low[2] + static_cast<int>(n / deep));
    });
  }
  // Calls f(y) for all y of its cells, shared among threads.
  template <class F> void each_y(const Threads &threads, double ns, const F &f) const
  {
    if (empty()) return;
    threads.parts(high[1] - low[1], ns * (high[0] - low[0]) * (high[2] - low[2]), [&](long from, long to) {
      for (long y = from; y < to; ++y) f(low[1] + static_cast<int>(y));
    });
  }
  // Calls f(x, y, z) for all its cells, x fastest.
  template <class F> void each(F &&f) const
  {
    for (int z = low[2]; z < high[2]; ++z)
      for (int y = low[1]; y < high[1]; ++y)
        for (int x = low[0]; x < high[0]; ++x) f(x, y, z);
  }
};

}    // namespace mdanim
