// SPDX-License-Identifier: GPL-2.0-only
// Lattice cells of the particles near the liquid.

#pragma once

#include "lammps/particle_value.h"
#include "pointers.h"
#include "threads/team.h"

#include <string>
#include <vector>

namespace mdanim {

// A particle is a corner of eight lattice cells at most, and no two of them have it at the same corner. So the order of corners
// gives sums over the cells of a particle that depend neither on ranks nor on the order of particles.
class NearCells : protected LAMMPS_NS::Pointers {
 public:
  explicit NearCells(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp) {}

  // Finds cells with a corner among `near`, local particles. `table`: corners 1 to 7 of the cell whose corner 0 a particle is,
  // ghosts as well. `fix` begins messages. Raises a LAMMPS error where a corner is out of reach.
  void find(const Threads &threads, const std::vector<int> &near, const ParticleTable &table, const std::string &fix);

  struct Cell {
    int corner[8];    // particles, in VTK order
    int layers;       // number of cells around it, where the table says so, else -1
  };
  std::vector<Cell> cells;
  void clear();    // the table is then read again
  // Calls f(cell) for the cells of the n-th particle near the liquid.
  template <class F> void each_of(std::size_t n, F &&f) const
  {
    for (int k = 0; k < 8; ++k)
      if (const int cell = of_particle[8 * n + k]; cell >= 0) f(cell);
  }
  double bytes() const
  {
    return static_cast<double>((cells.capacity() + all.capacity()) * sizeof(Cell) +
                               (of_particle.capacity() + number.capacity() + particles.capacity()) * sizeof(int) +
                               tags.capacity() * sizeof(LAMMPS_NS::tagint));
  }

 private:
  bool find_all(const Threads &threads, const ParticleTable &table);    // whether anything may have changed

  std::vector<Cell> all;                  // a corner out of reach is -1
  std::vector<LAMMPS_NS::tagint> tags;    // of the particles, with ghosts, at the time of the search
  std::vector<int> particles;             // near the liquid
  std::vector<int> of_particle;           // the cell that has it at corner k, or -1
  std::vector<int> number;                // place of a local particle in `near`, or -1
};

}    // namespace mdanim
