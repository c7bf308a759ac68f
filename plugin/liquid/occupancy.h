// SPDX-License-Identifier: GPL-2.0-only
// The cells of the automaton that a lattice body fills: sample points in its lattice cells, counted in whole numbers, so that the
// sum over bodies and ranks does not depend on their order. docs/physics-liquid.md.

#pragma once

#include "liquid/cell_box.h"
#include "liquid/rank_sums.h"
#include "numbers/vec3.h"
#include "threads/row_slabs.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace mdanim {

// Counts of samples of lattice cells, for each cell of the automaton; a cell with half of FULL is solid.
class Occupancy {
 public:
  static constexpr int FULL = 27 * 64;             // count of a cell that is filled: 27 samples at rest of weight 64
  static constexpr int FULL_SPREAD = 27 * 4096;    // the same where samples are spread

  Occupancy(int nx, int ny, int nz);

  // Adds a lattice cell by its corner points in VTK order, in units of the automaton's cells from the corner of its grid. Its
  // present volume is shared out over 3x3x3 points. `spread`: each of them is spread over all cells that the box around its part
  // of the lattice cell overlaps, in proportion, so that counts change smoothly as a body moves; cells inside a body of any
  // attitude get 0.98 of FULL_SPREAD and more. A lattice cell deep inside, with `layers` of others around it (unless negative),
  // only fills the cells near its middle. Writes only into these rows; returns false, and does nothing, where others are needed.
  // `reached` grows by the cells that are written to; touched.take_in(reached) must follow.
  bool add(const Vec3 corner[8], bool spread, int layers, const RowSlabs::Rows &rows, CellBox &reached);
  // Before the first mass after clear().
  void begin_mass();
  // Adds mass at a place, in cells of liquid; its softness, the compression in cells by a cell of liquid that stands on the
  // column; and its upward velocity, at most about 1000. They are shared among the four columns around, in whole numbers: in the
  // row of the place and the one before or after.
  void add_mass(const Vec3 &place, double mass, double softness, double rising);
  // The paper's literal rule: the cell that holds a particle is full.
  void add_particle(const Vec3 &place);

  // Counts the bodies of all ranks anew, which `add` adds on each of them. Returns a box that has all cells with a count before
  // or now. The result is the same on any number of ranks.
  CellBox count_anew(const std::function<void(Occupancy &)> &add, const RankSums &ranks, const Threads &threads);
  void clear(const Threads &threads);

  std::size_t number(int x, int y, int z) const { return (static_cast<std::size_t>(z) * ny + y) * nx + x; }

  int nx, ny, nz;
  std::vector<int> count;    // x fastest
  CellBox touched;           // all counts outside are 0
  double mass_of(long column) const { return sum_of(column, 0); }
  double softness_of(long column) const { return sum_of(column, 1); }
  double momentum_of(long column) const { return sum_of(column, 2); }    // upward

 private:
  void sum_over(const RankSums &ranks, const Threads &threads);
  void add_all(const RankSums &ranks);
  void add(const Vec3 &place, int weight, CellBox &reached);
  void add_points(const Vec3 corner[8], CellBox &reached);
  void add_spread(const Vec3 corner[8], CellBox &reached);
  bool fill_inside(const Vec3 corner[8], int layers, CellBox &reached);
  // A box that a weight is spread over; half edges of at most half a cell.
  struct Spread {
    static constexpr std::uint32_t SHARES = 1024;
    double reach[3];
    std::uint32_t weight;    // such that weight * SHARES is less than 2^32
    double shares[3] = {SHARES / std::max(2.0 * reach[0], 1e-9), SHARES / std::max(2.0 * reach[1], 1e-9),
                        SHARES / std::max(2.0 * reach[2], 1e-9)};
  };
  struct Samples;
  template <bool INSIDE>
  void spread_samples(const Samples &samples, const Spread &spread);    // whether all of them lie within the grid

  static constexpr int FILLED = 1 << 24;    // a bit of a count, far above FULL_SPREAD; a sum of 100 ranks fits
  static constexpr double SUM_UNIT = 1.0 / (1 << 24);
  double sum_of(long column, int which) const
  { return sums.empty() ? 0.0 : static_cast<double>(sums[3 * column + which]) * SUM_UNIT; }
  std::vector<std::int64_t> sums;    // mass, softness and momentum of each column, in units; empty before any is added
};

}    // namespace mdanim
