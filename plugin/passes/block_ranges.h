// SPDX-License-Identifier: GPL-2.0-only
// The ranges of blocks that threads take through a pass side by side, and the borders between them.

#pragma once

#include "geometry/aligned_array.h"
#include "passes/pass.h"
#include "passes/range_cut.h"

#include <vector>

namespace mdanim {

class BlockRanges {
 public:
  // `doubles`: numbers of a particle that springs across a border give, for a whole block.
  BlockRanges(RangeCut &&ranges, int doubles);

  const RangeCut &cut() const { return cuts; }
  std::vector<Crossing> &crossings() { return cuts.crossing; }
  const std::vector<Range> &all() const { return range; }
  Range &operator[](std::size_t n) { return range[n]; }
  // Sets the ranges of the first `active` blocks, which have something to do in a pass; `particles` of all blocks.
  void fill(const std::vector<Block> &blocks, int active, int particles, Pass &pass);
  void begin_pass(Pass &pass);
  void end_pass(const Pass &pass);    // for all ranges
  // Whether several ranges have blocks of an object that do not follow each other: with a trace, threads would write into one
  // row.
  bool objects_are_mixed() const { return mixed; }
  std::size_t bytes() const { return crossed.bytes() + shared_trace.bytes() + cuts.bytes(); }

 private:
  RangeCut cuts;
  std::vector<Range> range;
  std::vector<Border> border;
  Doubles crossed, shared_trace;
  unsigned turn = 0;    // passes so far
  bool mixed = false;
};

}    // namespace mdanim
