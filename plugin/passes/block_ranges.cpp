// SPDX-License-Identifier: GPL-2.0-only

#include "passes/block_ranges.h"

#include "geometry/boxes.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

namespace mdanim {

BlockRanges::BlockRanges(RangeCut &&ranges, int doubles)
    : cuts(std::move(ranges)), range(cuts.ranges()), border(cuts.ranges() - 1)
{
  crossed.assign(doubles * cuts.crossing.size());
  shared_trace.assign(2 * TRACE * range.size());
}

void BlockRanges::fill(const std::vector<Block> &all, int active, int particles, Pass &pass)
{
  pass.crossing = cuts.crossing.data();
  pass.crossing_entry = cuts.entry.data();
  pass.crossed = crossed.data();
  for (std::size_t n = 0; n < border.size(); ++n) {
    Border &own = border[n];
    own.first = n ? cuts.end_of_border[n - 1] : 0;
    own.crossings = cuts.end_of_border[n] - own.first;
    own.first_entry = own.first ? cuts.crossing[own.first - 1].end : 0;
    own.claimed = own.crossed = turn;
    std::copy_n(range[n + 1].f, 3, own.f);
  }
  const auto is_below = [](const Block &block, int particle) { return block.start < particle; };
  const auto first = [&](std::size_t n) {
    if (n == range.size()) return active;
    return static_cast<int>(std::lower_bound(all.begin(), all.begin() + active, cuts.first[n], is_below) - all.begin());
  };
  for (std::size_t n = 0; n < range.size(); ++n) {
    Range &own = range[n];
    own.first = first(n);
    own.blocks = first(n + 1) - own.first;
    own.first_entry = own.first ? all[own.first - 1].end : 0;
    own.end = n + 1 < range.size() ? cuts.first[n + 1] : particles;
    own.below = n && border[n - 1].crossings ? &border[n - 1] : nullptr;
    own.above = n < border.size() && border[n].crossings ? &border[n] : nullptr;
    const auto shared = [&](int before, int after) {
      return own.blocks && before >= 0 && after < active && all[before].object == all[after].object ? all[after].object : -1;
    };
    own.shared[0] = shared(own.first - 1, own.first);
    own.shared[1] = shared(own.first + own.blocks - 1, own.first + own.blocks);
    own.shared_trace = shared_trace.data() + 2 * TRACE * n;
  }
  mixed = false;
  std::unordered_set<int> seen;
  for (int n = 0; range.size() > 1 && n < active && !mixed; ++n)
    if (n == 0 || all[n].object != all[n - 1].object) mixed = !seen.insert(all[n].object).second;
}

void BlockRanges::begin_pass(Pass &pass)
{
  pass.turn = ++turn;
  const Box nothing;
  for (std::size_t n = 0; n < 2 * range.size(); ++n) {
    double *const row = shared_trace.data() + TRACE * n;
    std::copy_n(nothing.bound, 6, row);
    row[FASTEST] = 0.0;
  }
}

void BlockRanges::end_pass(const Pass &pass)
{
  if (!pass.trace) return;    // otherwise objects that several ranges have blocks of
  for (const Range &own : range)
    for (int side = 0; side < 2; ++side)
      for (int k = 0; own.shared[side] >= 0 && k < TRACE; ++k) {
        double &known = pass.trace[TRACE * own.shared[side] + k];
        known = std::min(known, own.shared_trace[TRACE * side + k]);
      }
}

}    // namespace mdanim
