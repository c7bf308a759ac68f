// SPDX-License-Identifier: GPL-2.0-only
// Changes of heads that are the same in all columns of a block, for the solver: those that conjugate gradients find last.

#pragma once

#include "liquid/waves/wave_columns.h"

#include <vector>

namespace mdanim {

// A preconditioner of multigrid: the system for heads of blocks of 4 x 4 columns, solved approximately by that for blocks of 2 x
// 2 of these, and so on up to a single one. Further spans have no part in it. All sums have a fixed order.
class WaveBlocks {
 public:
  explicit WaveBlocks(const WaveColumns &columns);

  // Makes the systems of all levels from that of the columns.
  void assemble(const WaveKernels &kernels);
  // Finds the correction for the sums of residuals that the kernel `gather` has found; returns the sum of both multiplied.
  double correct();

  double *row_sums() { return gathered.data(); }               // by gather()
  const double *corrections() const { return lift.data(); }    // for turn()

 private:
  // A system D x - sum of c x of the others = f, with an empty column and empty rows around.
  struct Level {
    Level(int nx, int ny);
    long place(int x, int y) const { return static_cast<long>(y + 1) * (nx + 1) + x + 1; }
    template <class F> void each(const F &f) const
    {
      for (int y = 0; y < ny; ++y)
        for (long i = place(0, y); i < place(nx, y); ++i) f(i);
    }
    double beside(long i) const    // sum of c x
    { return (east[i - 1] * x[i - 1] + east[i] * x[i + 1]) + (north[i - nx - 1] * x[i - nx - 1] + north[i] * x[i + nx + 1]); }

    int nx, ny;
    std::vector<double> diagonal, inverse, east, north;    // inverse: of the diagonal, 0 where nothing is
    std::vector<double> f, x, change;
  };

  static void sum_up(const Level &from, Level &to);
  static void complete(Level &level);
  void cycle(std::size_t n);

  const WaveColumns &columns;
  std::vector<Level> levels;
  std::vector<double> diagonal, couple[2];    // see BlockSums
  std::vector<double> gathered, lift;
};

}    // namespace mdanim
