// SPDX-License-Identifier: GPL-2.0-only
// Glue between the bodies of fix mdanim/rigid: its file, and what breaks in a step.

#pragma once

#include "lammps/object_table.h"
#include "lammps/rigid_particles.h"
#include "lammps/rigid_touching.h"
#include "records/byte_reader.h"
#include "rigid/glued_bodies.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace mdanim {

class RigidGlue {
 public:
  RigidGlue(LAMMPS_NS::LAMMPS *lmp, const RigidParticles &particles, RigidTouching &touching, std::vector<RigidBody> &bodies)
      : lmp(lmp), particles(particles), touching(touching), bodies(bodies)
  {
  }

  GluedBodies glued;

  void read_file(const char *file);
  // `collect` finds the forces of this step, if they are not there.
  std::vector<Output> outputs(const std::function<bool()> &collect, const double &half_dt, const std::vector<double> &drag);
  double torn_energy() const { return torn; }    // in units of mass times velocity squared
  // The lowest molecule ID of all that a body is glued together with.
  double molecule_of_whole(int body) const { return static_cast<double>(particles.objects().id(glued.first_of(body))); }
  // Load of the face by which a body hangs on the first one of its whole; `collect` as in `outputs`.
  FaceLoads load_of(int body, const std::function<bool()> &collect);
  // After forces on bodies were found.
  void gather(const std::vector<double> &drag)
  {
    glued.gather(bodies, drag);
    loads.clear();
  }
  void forget_bodies();
  // Pieces as they are now move as one body, where glue holds them together. `fix` begins messages.
  void join(const std::string &fix);
  // After contact has taken the bodies of records: what is left of those has the glue next.
  void unpack(const std::string &fix, std::vector<std::optional<ByteReader>> &rest);
  // Half a step of forces on all bodies that are not guided, and a step of their motion; what drag takes is added.
  void kick(double half_dt, const std::vector<double> &drag, bool first, double &drag_loss);
  void drift(double dt);
  // Kinetic energy of bodies, and of wholes in place of the pieces that are glued into them.
  double kinetic(double half_dt, const std::vector<double> &drag) const;
  // At the end of a step, with the velocities of whole steps: breaks glue. `collect` finds the forces of the next one, which are
  // those of the pieces.
  template <class Collect> void break_some(double half_dt, const std::vector<double> &drag, const Collect &collect)
  {
    if (!glued.may_break()) return;
    const double before = kinetic_of_all(half_dt, drag);
    if (!judge()) return;
    collect();
    torn += before - kinetic_of_all(half_dt, drag);    // all that pieces touch has other forces too
  }

 private:
  void take(const std::string &fix);
  // Whether a body moves by the forces on it, and not with others that it is glued to.
  bool is_mover(int n) const { return !bodies[n].aside && !bodies[n].guided && !bodies[n].asleep && !glued.holds(n); }
  template <class Work> void each_mover(double ns, const Work &work);
  void tell_contact();
  bool judge();    // whether glue broke
  double kinetic_of(int body, double half_dt, const std::vector<double> &drag) const;
  double kinetic_of_all(double half_dt, const std::vector<double> &drag) const;

  LAMMPS_NS::LAMMPS *lmp;
  const RigidParticles &particles;
  RigidTouching &touching;
  std::vector<RigidBody> &bodies;
  std::vector<GlueFace> faces;     // as the file has them
  std::vector<FaceLoads> loads;    // of bodies, once they were asked for
  double torn = 0.0;               // energy of contacts and motion that was lost where glue broke
};

}    // namespace mdanim
