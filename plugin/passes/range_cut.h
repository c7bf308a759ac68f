// SPDX-License-Identifier: GPL-2.0-only
// Cutting blocks into ranges, which threads take through a pass side by side.

#pragma once

#include "passes/cutter.h"

#include <vector>

namespace mdanim {

// Time of one thread for a pass over particles, some with dashpots or none [ns], approximately (bench/widths.py).
inline double ns_of_pass(int particles, bool damped) { return particles * (damped ? 40.0 : 30.0); }

// Ranges of a cut, and the springs across their borders, which are removed from the entries of their blocks (Border in pass.h).
struct RangeCut {
  std::vector<int> first;    // first particle of each range, ascending; at least one
  std::vector<Crossing> crossing;
  std::vector<Entry> entry;          // entries of these springs
  std::vector<int> end_of_border;    // one beyond its last crossing; border n lies below range n + 1

  int ranges() const { return static_cast<int>(first.size()); }
  std::size_t bytes() const { return crossing.capacity() * sizeof(Crossing) + entry.capacity() * sizeof(Entry); }
};

// Cuts into `wanted` ranges of equal cost at most, springs across their borders counted. They begin where chunks do. A spring
// crosses one border at most: where springs reach too far for that there are fewer ranges.
RangeCut cut_into_ranges(Cutter &cutter, Cut &cut, int wanted);

}    // namespace mdanim
