// SPDX-License-Identifier: GPL-2.0-only
// Before every pass each rank sends others the places of its particles that have springs to theirs: one message to each, from
// blocks to blocks.

#pragma once

#include "passes/simd_blocks.h"

#include <mpi.h>
#include <vector>

namespace mdanim {

// The ranks that have this one's particles as ghosts, and those that own its ghosts; one message to and from each before every
// pass.
class Ghosts {
 public:
  // Called by all ranks together whenever their blocks have been laid out: owners of this rank's ghosts, in the order of
  // blocks.ghost_places().
  void survey(MPI_Comm world, const std::vector<Home> &home, const SimdBlocks &blocks);
  // Called by all ranks together: ghosts take the places, and with `velocities` the velocities, that they have at their owners.
  void meet(MPI_Comm world, SimdBlocks &blocks, bool velocities);
  std::size_t bytes() const;

 private:
  struct Rank {
    int rank;
    std::vector<int> told, heard;    // particles, in the order of the blocks
    std::vector<double> out, in;
  };
  std::vector<Rank> others;
  std::vector<MPI_Request> requests;
};

}    // namespace mdanim
