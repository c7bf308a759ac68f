// SPDX-License-Identifier: GPL-2.0-only
// How a fix that adds forces takes part in passes over blocks (pass.h), which keep positions and velocities in arrays of their
// own.

#ifndef MDANIM_PASS_PARTICIPANT_H
#define MDANIM_PASS_PARTICIPANT_H

#include "engine/pair_filter.h"
#include "engine/positions.h"
#include "laws/vec3.h"

#include <vector>

namespace mdanim {

// Where the forces on the particles of one participant are added up, zero at first.
class ForceSums {
 public:
  // Components of the sum for particle n lie at slot[n], slot[n] + apart and slot[n] + 2 apart.
  ForceSums(double *sums, const long *slot, long apart) : sums(sums), slot(slot), apart(apart) {}
  void add(std::size_t n, const Vec3 &force) const
  {
    double *const to = sums + slot[n];
    to[0] += force.x;
    to[apart] += force.y;
    to[2 * apart] += force.z;
  }
  void clear(std::size_t n) const { sums[slot[n]] = sums[slot[n] + apart] = sums[slot[n] + 2 * apart] = 0.0; }

 private:
  double *sums;
  const long *slot;
  long apart;
};

// A fix whose forces run_style verlet/mdanim can combine with passes. It names the particles that it needs, tells whether
// positions are all that its forces depend on, and how far particles may go before it needs new lists.
class PassParticipant {
 public:
  // The local particles whose x, v and f the fix reads or writes in post_force() and end_of_step(), until lists are rebuilt; the
  // arrays of LAMMPS hold no others. Adds them to `particles`, some perhaps twice.
  virtual void append_required_atoms(std::vector<int> &particles) const = 0;
  // Whether, in this whole run, all that the fix does in a step is to add forces that depend on the positions of these particles
  // alone, each of which is named once. It may then be asked for them instead, before the pass, which adds them: as many as
  // append_required_atoms() names, in that order, those of ghosts without meaning.
  virtual bool depends_on_positions_only() const { return false; }
  virtual void add_forces(const Positions & /*place*/, const ForceSums & /*force*/) {}
  // What kind of processor to compute for.
  virtual void set_pair_filter(const PairFilter &) {}
  // Whether it will read any particle in this step. Asked once, when the step has begun, unless positions are all that it needs.
  virtual bool needs_all_atoms() { return false; }
  // How far particles may go from where they stood when lists were made before it must look again, as far as it can tell: who has
  // nothing to do until then says so here, and lists last longer than half the skin.
  virtual double safe_displacement() const { return 0.0; }
  // Whether a motion that all particles share counts. To who asks for distances between particles alone it does not.
  virtual bool sees_absolute_position() const { return true; }

 protected:
  ~PassParticipant() = default;
};

}    // namespace mdanim

#endif
