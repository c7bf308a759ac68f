// SPDX-License-Identifier: GPL-2.0-only
// Strips: blocks that a pass takes offset by offset (spring_kernel.h).

#pragma once

#include "passes/cutter.h"
#include "passes/range_cut.h"

#include <vector>

namespace mdanim {

// Sets the strips of blocks: neighbours without gaps, in one range and away from its borders, with entries of the same offsets;
// and whether entries of a block alone overlap.
void set_strips(std::vector<Block> &block, const std::vector<Entry> &entry, int lanes, const RangeCut &ranges);

}    // namespace mdanim
