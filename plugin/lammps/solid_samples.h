// SPDX-License-Identifier: GPL-2.0-only
// Solids of LAMMPS as samples on the grid of a liquid.

#pragma once

#include "lammps/buoyancy.h"
#include "lammps/keywords.h"
#include "lammps/named_group.h"
#include "lammps/near_cells.h"
#include "lammps/particle_value.h"
#include "liquid/basin.h"
#include "threads/row_slabs.h"

#include "pointers.h"

#include <string>
#include <vector>

namespace mdanim {

// The particles of a group: their lattice cells, or where those are not given, or the paper's literal rule is asked for, the
// cells of the liquid that particles lie in.
class SolidSamples : protected LAMMPS_NS::Pointers {
 public:
  // `group` is the bit of the group.
  SolidSamples(LAMMPS_NS::LAMMPS *lmp, int group, const Buoyancy &buoyancy) : Pointers(lmp), group(group), buoyancy(buoyancy) {}

  // Keywords of the command and of fix_modify. `changed` becomes true when one is read.
  std::vector<Keyword> keywords(bool &changed);
  // Checks the properties again; `fix` begins messages. `literal`: the paper's rule.
  void init(bool literal, const std::string &fix);
  void use(const Threads &now) { threads = now; }

  bool by_cells() const { return cells.given() && !literal; }
  const ParticleTable &lattice_cells() const { return cells; }
  bool is_still(int i) const;
  // Bodies that never move (or all others), as far as they are below a height.
  Basin::AddBodies bodies(const Basin &basin, bool still);
  // Bodies that may move, of which all parts that are below such a height have been listed.
  Basin::AddBodies bodies_near(const Basin &basin, const std::vector<int> &near);
  std::size_t bytes() const { return slabs.bytes(); }

  NamedGroup still_group;
  NamedGroup driven_group;       // what goes its way whatever the liquid does
  bool none_is_still = false;    // in a basin that moves: what stands in the world is driven there

 private:
  int row_at(const Basin &basin, double y) const;
  void add_particles(Occupancy &into, const Basin &basin, const std::vector<int> &these, double below) const;
  void add_bodies(Occupancy &into, const Basin &basin, const std::vector<int> &these, const NearCells &with, bool still,
                  double below);
  void add_mass(Occupancy &into, const Basin &basin, const std::vector<int> &these, double below);

  const int group;
  const Buoyancy &buoyancy;
  Threads threads;
  RowSlabs slabs;
  std::string fix;
  bool literal = false;
  ParticleTable cells;
  ParticleColumn softness;    // volume over Young's modulus
};

}    // namespace mdanim
