// SPDX-License-Identifier: GPL-2.0-only
// Solids in the basin as the waves take them: parts of cells, and masses that float in columns.

#pragma once

#include "liquid/basin.h"
#include "liquid/waves/added_mass.h"
#include "liquid/waves/waves.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mdanim {

class SolidColumns {
 public:
  // Values that a state has, besides parts of cells, which the waves have as well.
  struct Values {
    std::vector<double> mass;                 // of floating bodies in each column, in cells of liquid, as given to the liquid
    std::vector<AddedMass::Solids> afloat;    // what moves in each column
    long moving = 0;                          // cells with moving solids
    std::uint64_t still_known = 0;            // a checksum of the solids that never move
  };

  SolidColumns(int nx, int ny, int nz);

  // Marks bodies of all ranks that never move, walls of the waves. Returns whether they are others than before.
  bool mark_still(const Basin::AddBodies &bodies, const RankSums &ranks, const Threads &threads, Waves &waves);
  // Marks all other bodies as far as they are below a height. `period`: time between updates, in sqrt(cell/g).
  void mark_moving(const Basin::AddBodies &bodies, double below, double period, const RankSums &ranks, const Threads &threads);
  // Gives the waves what has changed since the last call; `again` as in Waves::set_solids().
  void give_to(Waves &waves, double again = 1.0);
  // Sets the state; parts of cells are those of the waves.
  void set(Values &&values, const SolidParts &parts);

  const Values &now() const { return values; }
  bool is_solid(int column, int z) const { return 2 * part[number(column, z)] >= SolidParts::FULL; }
  // Whether a cell that is not open belongs to a body that floats.
  bool floats(int column, int z) const;
  long solid_cells() const;
  double bytes() const { return static_cast<double>(part.size()) * (2.0 * sizeof(int) + sizeof part[0]); }

 private:
  std::size_t number(int column, int z) const { return static_cast<std::size_t>(column) * still.nz + z; }
  void set_walls(Waves &waves) const;
  void find_parts(const Threads &threads);
  void find_masses(double period, const Threads &threads);

  Occupancy still, mobile;
  CellBox marked, changed;            // cells outside are open; the cells that the waves know
  std::vector<std::uint16_t> part;    // solid part of each cell, see SolidParts
  Values values;
  std::uint64_t walled_for;    // the checksum for which the waves have set their walls
};

}    // namespace mdanim
