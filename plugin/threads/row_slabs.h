// SPDX-License-Identifier: GPL-2.0-only
// Loops over bodies that write into the cells around them, shared among threads.

#pragma once

#include "threads/team.h"

#include <algorithm>
#include <vector>

namespace mdanim {

// Rows of a grid in slabs. Work of a slab writes into the slab and into half of the slabs beside it. Threads take every second
// slab, then the others, so that none writes where another does.
class RowSlabs {
 public:
  struct Rows {
    int low, high;    // [low, high)
  };
  static int slabs_of(int rows) { return (rows + THICKNESS - 1) / THICKNESS; }

  // Calls work(n, rows, slab) for n from 0 to size - 1, each of which takes one thread about so many ns. It may write into these
  // rows; where that is not enough it returns false, writes nothing, and is called again with all rows of the grid, by one
  // thread. `row_of(n)` is the row of its middle, or any one where that lies outside. The order of calls is any, but no two calls
  // at a time are of the same slab, a number from 0 to slabs_of(rows) - 1.
  template <class RowOf, class Work>
  void each(const Threads &threads, int rows, long size, double ns, const RowOf &row_of, const Work &work)
  {
    const Rows all{0, rows};
    const double whole = ns * static_cast<double>(size);
    if (!threads.pays(whole)) {
      for (long n = 0; n < size; ++n) work(n, all, 0);
      return;
    }
    const int slabs = slabs_of(rows);
    sort(threads, slabs, size, row_of);
    std::vector<std::vector<int>> left(slabs);
    for (int odd = 0; odd < 2; ++odd) {
      const int many = (slabs - odd + 1) / 2, tasks = std::min(many, Team::MOST_TASKS);
      threads.each(tasks, 0.5 * whole, [&](int task) {
        for (int slab = 2 * task + odd; slab < slabs; slab += 2 * tasks) {
          const Rows own{std::max(0, slab * THICKNESS - THICKNESS / 2), std::min(rows, (slab + 1) * THICKNESS + THICKNESS / 2)};
          for (int k = first[slab]; k < first[slab + 1]; ++k)
            if (!work(order[k], own, slab)) left[slab].push_back(order[k]);
        }
      });
    }
    for (const std::vector<int> &of_slab : left)
      for (const int n : of_slab) work(n, all, 0);
  }
  std::size_t bytes() const { return slab_of.capacity() * sizeof(int) + order.capacity() * sizeof(int); }

 private:
  static constexpr int THICKNESS = 6;    // even

  template <class RowOf> void sort(const Threads &threads, int slabs, long size, const RowOf &row_of)
  {
    constexpr double LOOK = 4.0;    // [ns], to look at one body
    slab_of.resize(size), order.resize(size);
    threads.parts(size, LOOK, [&](long from, long to) {
      for (long n = from; n < to; ++n) slab_of[n] = std::clamp(row_of(n) / THICKNESS, 0, slabs - 1);
    });
    first.assign(slabs + 1, 0);
    for (const int slab : slab_of) ++first[slab + 1];
    for (int slab = 0; slab < slabs; ++slab) first[slab + 1] += first[slab];
    std::vector<int> next(first.begin(), first.end() - 1);
    for (long n = 0; n < size; ++n) order[next[slab_of[n]]++] = static_cast<int>(n);
  }

  std::vector<int> slab_of, order, first;    // slab of each n; all n slab by slab; where those of each slab begin
};

}    // namespace mdanim
