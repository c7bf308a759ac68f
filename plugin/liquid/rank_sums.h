// SPDX-License-Identifier: GPL-2.0-only
// Sums and minima of whole numbers over ranks, without MPI.

#pragma once

#include <cstdint>

namespace mdanim {

// Called by all ranks together. For a process that is alone this class itself is used, which changes nothing. Whole numbers only:
// their sums do not depend on the order of ranks.
class RankSums {
 public:
  virtual ~RankSums() = default;
  virtual bool alone() const { return true; }
  virtual bool first() const { return true; }    // whether this is the first rank
  virtual void add(int * /*values*/, int /*count*/) const {}
  virtual void add_wide(std::int64_t * /*values*/, int /*count*/) const {}
  virtual void lowest(int * /*values*/, int /*count*/) const {}
};

}    // namespace mdanim
