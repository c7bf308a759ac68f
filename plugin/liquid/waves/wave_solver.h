// SPDX-License-Identifier: GPL-2.0-only
// (W5) to (W7): the change of heads in an update, one system of equations for all spans.

#pragma once

#include "liquid/waves/wave_blocks.h"
#include "liquid/waves/wave_loops.h"
#include "liquid/waves/wave_mouths.h"
#include "liquid/waves/wave_pockets.h"

namespace mdanim {

class WaveSolver {
 public:
  // All must outlive this.
  WaveSolver(WaveColumns &columns, WaveRun &run, const WaveMouths &mouths)
      : columns(columns), run(run), mouths(mouths), law(run.law), arrays(columns.arrays), loops(columns, run.threads),
        blocks(columns), pockets(columns)
  {
  }

  // Heads that push at the end of a sub-update, from surfaces and links after advection; spans whose roof would pull become free.
  // `were_full`: whether some span was full in the last one.
  void find_heads(bool were_full);

 private:
  using LinkPlace = WaveColumns::LinkPlace;
  using Ends = WaveColumns::Ends;

  void assemble(bool some_full);
  void forget_beside(const std::vector<std::uint8_t> &freed);
  void solve(bool again, bool with_blocks);
  void descend(double left, double enough, bool with_blocks);
  bool let_go();
  bool let_go_in(long row);
  double sum_of_rows() const;
  void general_assembly(long i);
  void general_coupling(const LinkPlace &link);
  double general_product(long i, const double *x) const;

  WaveColumns &columns;
  WaveRun &run;
  const WaveMouths &mouths;
  const WaveLaw &law;
  WaveArrays &arrays;
  WaveLoops loops;
  WaveBlocks blocks;
  WavePockets pockets;
  std::vector<std::uint8_t> stale;    // rows whose part of the system is to be made anew
};

}    // namespace mdanim
