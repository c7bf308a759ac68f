// SPDX-License-Identifier: GPL-2.0-only
// Forces of the liquid of fix mdanim/liquid on particles. Wcislo 1999, sec. 4.3.

#pragma once

#include "lammps/keywords.h"
#include "lammps/near_cells.h"
#include "lammps/particle_value.h"
#include "liquid/basin.h"
#include "passes/pass.h"
#include "pointers.h"
#include "threads/team.h"

#include <functional>
#include <string>
#include <vector>

namespace mdanim {

// Lift of particles by their volumes, and drag; and the ledger of both. A part of fix mdanim/liquid: it acts on the particles
// that the fix has found near the liquid, and its ledger is a part of the liquid's state.
class Buoyancy : protected LAMMPS_NS::Pointers {
 public:
  // `rho` is the liquid's density.
  Buoyancy(LAMMPS_NS::LAMMPS *lmp, double rho) : Pointers(lmp), rho(rho), cells(lmp) {}

  std::vector<Keyword> keywords();    // of the command and of fix_modify
  // Refuses keywords that do not fit together. `fix` begins messages.
  void init(const std::string &fix);

  // Called for new lists. The first leaves particles of a group only the friction that they have without the liquid; the second
  // finds the lattice cells of the particles near the liquid.
  void clear_friction(int groupbit) const;
  void find_cells(const std::vector<int> &near, const ParticleTable &table, const std::string &fix)
  { cells.find(threads, near, table, fix); }
  void forget_cells() { cells.clear(); }
  const NearCells &lattice_cells() const { return cells; }
  // Gives the liquid the impulses from solids since the last call, and its push on them.
  void give_impulses(Basin &basin, const std::vector<int> &near);
  // Computes the values of the liquid at particles, which hold until the next call.
  void look(const Basin &basin, const std::vector<int> &near);
  // Adds forces and sets friction; in a step the reaction acts on the liquid.
  void act(const Basin &basin, const std::vector<int> &near, bool in_step);
  // The ledger begins at the present velocities, or where it was set, and goes on by a step.
  void begin_ledger();
  void go_on_with_ledger();
  void use(const Threads &now) { threads = now; }    // for steps; the bits are the same for any number of them

  // For passes (passes/pass_liquid.h): whether they compute the same as act(), where the integrator has friction or not, and
  // reads it from a column or not; a particle; the part of a volume at a place below the surface; all particles; and the results
  // of passes in this step.
  bool acts_in_passes(bool has_friction, const double *lambda) const;
  std::function<Immersed<double>(int)> immersed(const std::vector<char> &is_near, const double *lambda) const;
  void parts_below(const Basin &basin, const double *const *x, int first, int many, double *part) const;
  LiquidScales scales(const Basin &basin, bool in_step) const;
  void add_power(const Basin::Energies &of_passes, double more_seconds);

  // Sum over all ranks; setting it puts all of it on the first rank.
  Basin::Ledger ledger() const;
  void set_ledger(const Basin::Ledger &ledger);
  double density() const { return rho; }
  // Gravity as a force on a mass [force/mass]; the basin's gravity is an acceleration.
  double weight(const Basin &basin) const;
  double bytes() const
  {
    return static_cast<double>(wet.capacity() * sizeof(Wet) + on_parts.capacity() * sizeof on_parts[0] +
                               kept.capacity() * sizeof kept[0]) +
           cells.bytes();
  }
  double seconds = 0.0;
  int standing = 0;    // bit of the group of what stands in a basin that moves: nothing acts on it, and it keeps no state
  int driven = 0;      // bit of the group of what no integrator moves: drag is a force on it

  // Values of a particle, from look() to look(); they go with the particle.
  std::vector<InLiquid> kept;    // of all local particles, where the liquid acts on lattice cells

 private:
  struct Wet {    // a particle near the liquid, in this step
    int i;        // negative where the liquid does not act on it
    Vec3 push;
    double lambda;
  };

  struct Surface;
  struct Acting;
  Wet act_on(const Acting &now, int i);
  InLiquid look_at_particle(const Basin &basin, std::size_t n, const double *x) const;
  Basin::Energies power() const;

  double rho;
  Threads threads;
  bool lifts = false, slows = false, is_quadratic = false;
  ParticleValue volume, gamma, per_length;
  ParticleColumn lambda_column, base_column;

  std::vector<Wet> wet;
  NearCells cells;
  std::vector<Basin::OnParts> on_parts;    // for each lattice cell
  Basin::Ledger own;                       // sum of this rank
  Basin::Energies in_passes;               // power of particles that are not in `wet`, in this step
  bool ledger_was_set = false;             // since the last step
};

}    // namespace mdanim
