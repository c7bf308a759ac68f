// SPDX-License-Identifier: GPL-2.0-only
// Finds borders, and the springs that cross them.

#include "passes/range_cut.h"

#include <algorithm>

namespace mdanim {

// Cost of a block besides its springs, in vectors of springs: gravity, friction and motion.
static constexpr int MOTION_COST = 6;
// A border moves to the beginning of an object within this fraction of a range.
static constexpr int NEAR = 16;

namespace {

class RangeCutter {
 public:
  RangeCutter(Cutter &cutter, Cut &cut) : cutter(cutter), cut(cut), lanes(cutter.lanes()) {}

  void find_borders(int wanted);
  void take_out_crossings();

  RangeCut found;

 private:
  unsigned first_entry(std::size_t block) const { return block ? cut.block[block - 1].end : 0; }
  bool begins_chunk(std::size_t block) const { return cut.block[block].chunk != cut.block[block - 1].chunk; }
  bool begins_object(std::size_t block) const { return cut.block[block].object != cut.block[block - 1].object; }
  std::size_t best_block(long ideal, long near) const;
  int reach(std::size_t border) const;
  template <class Tell> void split(const Block &block, const Entry &entry, int end, Tell tell) const;

  Cutter &cutter;
  Cut &cut;
  const int lanes;
  std::vector<long> cost{0};    // cost of all blocks before each
};

// The springs of an entry below a border and across it: calls tell(crosses, row) for each part that is not empty.
template <class Tell> void RangeCutter::split(const Block &block, const Entry &entry, int end, Tell tell) const
{
  const double *const row = cutter.row(block.damped, entry.law);
  const int length = cutter.row_length(block.damped);
  std::vector<double> part(length);
  for (const bool across : {false, true}) {
    bool some = false;
    for (int k = 0; k < length; ++k) {
      const bool is_across = block.start + k % lanes + entry.offset >= end;
      part[k] = is_across == across ? row[k] : 0.0;
      some = some || part[k] != 0.0;
    }
    if (some) tell(across, part.data());
  }
}

// One beyond the highest particle that a spring leads to across a border.
int RangeCutter::reach(std::size_t border) const
{
  const int at = cut.block[border].start;
  int high = at;
  for (std::size_t n = border; n-- > 0 && cut.block[n].start + lanes + cut.farthest > at;) {
    const Block &block = cut.block[n];
    for (unsigned e = first_entry(n); e < block.end; ++e) {
      const int last = block.start + block.lanes - 1 + cut.entry[e].offset;
      if (last >= at) high = std::max(high, last + 1);    // a lane may have no such spring: refusing a border costs little
    }
  }
  return high;
}

// The block that begins a chunk, and if possible an object, nearest to a cost.
std::size_t RangeCutter::best_block(long ideal, long near) const
{
  const std::size_t blocks = cut.block.size();
  const auto distance = [&](std::size_t n) { return std::labs(cost[n] - ideal); };
  const std::size_t at = std::lower_bound(cost.begin(), cost.end(), ideal) - cost.begin();
  std::size_t best = 0;
  for (std::size_t n = std::max<std::size_t>(at, 1); n < blocks; ++n)
    if (begins_chunk(n)) {
      best = n;
      break;
    }
  for (std::size_t n = std::min(at, blocks); n-- > 1;)
    if (begins_chunk(n)) {
      if (!best || distance(n) < distance(best)) best = n;
      break;
    }
  std::size_t object = 0;
  for (std::size_t n = 1; n < blocks; ++n)
    if (begins_object(n) && distance(n) <= near && (!object || distance(n) < distance(object))) object = n;
  return object ? object : best;
}

void RangeCutter::find_borders(int wanted)
{
  found.first.assign(1, 0);
  for (std::size_t n = 0; n < cut.block.size(); ++n)
    cost.push_back(cost.back() + MOTION_COST + static_cast<long>(cut.block[n].end - first_entry(n)));
  int reached = 0;    // reached by springs over the last border, and by lanes that are loaded with them
  for (int r = 1; r < wanted; ++r) {
    const std::size_t border = best_block(cost.back() * r / wanted, cost.back() / wanted / NEAR);
    if (!border) break;
    const int at = cut.block[border].start;
    if (at <= found.first.back() || reached > at) continue;
    found.first.push_back(at);
    reached = reach(border) + lanes;
  }
}

void RangeCutter::take_out_crossings()
{
  std::vector<Entry> inside;
  unsigned e = 0;
  int r = 0;
  for (Block &block : cut.block) {
    while (r + 1 < found.ranges() && block.start >= found.first[r + 1]) {
      found.end_of_border.push_back(static_cast<int>(found.crossing.size()));
      ++r;
    }
    if (r + 1 == found.ranges()) {    // nothing lies above
      for (; e < block.end; ++e) inside.push_back(cut.entry[e]);
      block.end = static_cast<unsigned>(inside.size());
      continue;
    }
    const int end = found.first[r + 1];
    const std::size_t had = found.entry.size();
    block.at_border = block.start + lanes > end;
    for (; e < block.end; ++e) {
      const Entry entry = cut.entry[e];
      if (block.start + lanes + entry.offset <= end) {
        inside.push_back(entry);
        continue;
      }
      block.at_border = true;
      split(block, entry, end, [&](bool across, const double *row) {
        (across ? found.entry : inside).push_back({entry.offset, cutter.add_row(block.damped, row)});
      });
    }
    block.end = static_cast<unsigned>(inside.size());
    if (found.entry.size() == had) continue;
    block.crossing = static_cast<int>(found.crossing.size());
    found.crossing.push_back({block.start, block.damped, static_cast<unsigned>(found.entry.size()), 0});
  }
  cut.entry.swap(inside);
}

}    // namespace

RangeCut cut_into_ranges(Cutter &cutter, Cut &cut, int wanted)
{
  RangeCutter ranges(cutter, cut);
  ranges.find_borders(wanted);
  if (ranges.found.ranges() > 1) ranges.take_out_crossings();
  return ranges.found;
}

}    // namespace mdanim
