// SPDX-License-Identifier: GPL-2.0-only
// How a fix that adds forces works together with run_style verlet/mdanim, which keeps positions and velocities in arrays of its
// own.

#ifndef MDANIM_GUEST_H
#define MDANIM_GUEST_H

#include "engine/places.h"
#include "engine/touch.h"
#include "laws/vec3.h"

#include <vector>

namespace mdanim {

// Where the forces on the particles of a guest are added up, nothing at first.
class Sums {
 public:
  // Components of the sum for particle n lie at slot[n], slot[n] + apart and slot[n] + 2 apart.
  Sums(double *sums, const long *slot, long apart) : sums(sums), slot(slot), apart(apart) {}
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

class Guest {
 public:
  // The local particles whose x, v and f the fix reads or writes in post_force() and end_of_step(), until lists are rebuilt; the
  // arrays of LAMMPS hold no others. Adds them to `particles`, some perhaps twice.
  virtual void concerned(std::vector<int> &particles) const = 0;
  // Whether, in this whole run, all that the fix does in a step is to add forces that depend on the places of these particles
  // alone, each of which is named once. It may then be asked for them instead, before the pass, which adds them: as many as
  // concerned() names, in that order, those of ghosts without meaning.
  virtual bool places_suffice() const { return false; }
  virtual void forces(const Places & /*place*/, const Sums & /*force*/) {}
  // What kind of processor to compute for.
  virtual void use(const Touch &) {}
  // Whether it will read any particle in this step. Asked once, when the step has begun, unless places suffice.
  virtual bool reads_all() { return false; }
  // How far particles may go from where they stood when lists were made before it must look again, as far as it can tell: who has
  // nothing to do until then says so here, and lists last longer than half the skin.
  virtual double looks_ahead() const { return 0.0; }
  // Whether a motion that all particles share counts. To who asks for distances between particles alone it does not.
  virtual bool minds_drift() const { return true; }

 protected:
  ~Guest() = default;
};

}    // namespace mdanim

#endif
