// SPDX-License-Identifier: GPL-2.0-only
// Finds borders, and the springs that cross them.

#include "passes/range_cut.h"

#include "passes/strips.h"

#include <algorithm>
#include <limits>

namespace mdanim {

// Cost of a block besides its springs, in vectors of springs: gravity, friction and motion; and more where it stands alone
// instead of in a strip.
static constexpr long MOTION_COST = 6, ALONE_COST = 3;
// Cost of a vector of springs across a border, to the range above: these springs come one block at a time, with places and forces
// that another thread's processor has in its cache.
static constexpr long CROSSING_COST = 4;

namespace {

class RangeCutter {
  // A border below a block.
  struct RangeBorder {
    std::size_t block;
    int reach;        // one beyond the highest particle that a spring leads to across it
    long crossing;    // cost of these springs
  };

 public:
  RangeCutter(Cutter &cutter, Cut &cut) : cutter(cutter), cut(cut), lanes(cutter.lanes()) {}

  void find_borders(int wanted);
  void take_out_crossings();

  RangeCut found;

 private:
  unsigned first_entry(std::size_t block) const { return block ? cut.block[block - 1].end : 0; }
  bool begins_chunk(std::size_t block) const { return cut.block[block].chunk != cut.block[block - 1].chunk; }
  RangeBorder border_at(std::size_t block) const;
  RangeBorder best_border(long before, int ranges) const;
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

RangeCutter::RangeBorder RangeCutter::border_at(std::size_t block) const
{
  const int at = cut.block[block].start;
  RangeBorder found{block, at, 0};
  for (std::size_t n = block; n-- > 0 && cut.block[n].start + lanes + cut.farthest > at;)
    for (unsigned e = first_entry(n); e < cut.block[n].end; ++e) {
      const int last = cut.block[n].start + cut.block[n].lanes - 1 + cut.entry[e].offset;
      if (last < at) continue;    // a lane may have no such spring: refusing a border costs little
      found.reach = std::max(found.reach, last + 1);
      found.crossing += CROSSING_COST;
    }
  return found;
}

// The border, where a chunk begins, with which the dearest of this range and the mean of the `ranges` above costs least. The
// range begins after a cost of `before`, with which springs across its lower border are counted.
RangeCutter::RangeBorder RangeCutter::best_border(long before, int ranges) const
{
  RangeBorder best{};
  double least = std::numeric_limits<double>::infinity();
  const auto mean_above = [&](std::size_t n, long crossing) {
    return static_cast<double>(cost.back() - cost[n] + crossing) / ranges;
  };
  const auto below = [&](std::size_t n) { return static_cast<double>(cost[n] - before); };
  const auto try_at = [&](std::size_t n) {
    if (!begins_chunk(n)) return;
    const RangeBorder here = border_at(n);
    const double dearest = std::max(below(n), mean_above(n, here.crossing));
    if (dearest < least) best = here, least = dearest;
  };
  const std::size_t blocks = cut.block.size();
  const long even = before + (cost.back() - before) / (ranges + 1);
  const std::size_t at = std::lower_bound(cost.begin(), cost.end(), even) - cost.begin();
  for (std::size_t n = std::max<std::size_t>(at, 1); n < blocks && below(n) < least; ++n) try_at(n);
  for (std::size_t n = std::min(at, blocks); n-- > 1 && mean_above(n, 0) < least;) try_at(n);
  return best;
}

void RangeCutter::find_borders(int wanted)
{
  found.first.assign(1, 0);
  if (wanted < 2) return;
  set_strips(cut.block, cut.entry, lanes, found);
  int strip = 0;
  for (std::size_t n = 0; n < cut.block.size(); ++n) {
    const Block &block = cut.block[n];
    if (block.strip) strip = block.strip;
    cost.push_back(cost.back() + MOTION_COST + (strip == 1 ? ALONE_COST : 0) + static_cast<long>(block.end - first_entry(n)));
  }
  long before = 0;
  int reached = 0;    // reached by springs over the last border, and by lanes that are loaded with them
  for (int r = 1; r < wanted; ++r) {
    const RangeBorder border = best_border(before, wanted - r);
    if (!border.block) break;
    const int at = cut.block[border.block].start;
    if (at <= found.first.back() || reached > at) continue;
    found.first.push_back(at);
    reached = border.reach + lanes;
    before = cost[border.block] - border.crossing;
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
