// SPDX-License-Identifier: GPL-2.0-only

#include "passes/strips.h"

#include <algorithm>

namespace mdanim {

// A shorter strip takes longer than its blocks one by one (docs/decisions/one-pass.md).
constexpr std::size_t SHORTEST = 4;

void set_strips(std::vector<Block> &block, const std::vector<Entry> &entry, int lanes, const RangeCut &ranges)
{
  const auto first_entry = [&](std::size_t n) { return n ? block[n - 1].end : 0; };
  const auto begins_range = [&](std::size_t n) {
    return std::binary_search(ranges.first.begin(), ranges.first.end(), block[n].start);
  };
  const auto equal = [](const Entry &a, const Entry &b) { return a.offset == b.offset; };
  const auto follows = [&](std::size_t n) {    // the block before it in a strip
    const Block &own = block[n], &before = block[n - 1];
    const Entry *const entries = entry.data();
    return own.start == before.start + lanes && own.damped == before.damped && !own.at_border && !before.at_border &&
           !begins_range(n) && own.end > first_entry(n) &&
           std::equal(entries + first_entry(n), entries + own.end, entries + first_entry(n - 1), entries + before.end, equal);
  };
  const auto overlaps = [&](std::size_t n) {
    unsigned overlapping = 0;
    for (unsigned e = first_entry(n) + 1; e < block[n].end; ++e) overlapping += entry[e - 1].offset - entry[e].offset < lanes;
    return 3 * overlapping >= 2 * (block[n].end - first_entry(n));    // docs/decisions/one-pass.md
  };
  for (std::size_t n = 0; n < block.size();) {
    std::size_t end = n + 1;
    while (end < block.size() && end - n < LONGEST_STRIP && follows(end)) ++end;
    if (end - n < SHORTEST) end = n + 1;
    block[n].overlaps = end == n + 1 && overlaps(n);
    for (std::size_t k = n; k < end; ++k) block[k].strip = k == n ? static_cast<short>(end - n) : 0;
    n = end;
  }
}

}    // namespace mdanim
