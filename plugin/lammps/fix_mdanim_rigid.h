// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/rigid: objects that do not deform.

#pragma once

#include "lammps/fix_base.h"
#include "lammps/guided_bodies.h"
#include "lammps/rigid_forces.h"
#include "lammps/rigid_glue.h"
#include "lammps/rigid_particles.h"
#include "lammps/rigid_sleep.h"
#include "lammps/rigid_touching.h"
#include "lammps/stateful.h"
#include "passes/pass_participant.h"
#include "rigid/body.h"
#include "rigid/inertia.h"

#include <map>
#include <optional>
#include <vector>

namespace LAMMPS_NS {

// Moves the particles of each object of its group as one rigid body, by the sums of the forces on them and by contact with other
// bodies. Every rank has all bodies; sums over particles have the same bits in any order, so that bodies are the same on any
// number of ranks.
class FixMdanimRigid : public mdanim::FixBase, public mdanim::Stateful, public mdanim::Equipped {
 public:
  FixMdanimRigid(class LAMMPS *, int, char **);
  ~FixMdanimRigid() override;

  void equip(const mdanim::Kernels &, const mdanim::Threads &now) override { particles.use(now), touching.contact.use(now); }
  int setmask() override;
  void init() override;
  void setup(int) override;
  void setup_pre_neighbor() override;
  void pre_neighbor() override;
  void reset_dt() override;
  void initial_integrate(int) override;
  void final_integrate() override;
  double compute_scalar() override;
  double compute_array(int body, int column) override;
  bigint dof(int group) override { return particles.degrees_taken(group); }
  double memory_usage() override;

  void grow_arrays(int n) override { particles.grow(n); }
  void copy_arrays(int from, int to, int) override { particles.copy(from, to); }
  void set_arrays(int i) override
  {
    particles.clear(i);
    has_new_particles = true;
  }
  int pack_exchange(int i, double *buffer) override { return particles.pack(i, buffer); }
  int unpack_exchange(int i, double *buffer) override { return particles.unpack(i, buffer); }

  void write_restart(FILE *) override;
  void restart(char *) override;
  mdanim::StateRecords pack() const override;
  void unpack(const mdanim::StateRecords &records) override;

 private:
  void tell_numbers();
  void locate();
  void make();
  void set_velocities(const std::vector<mdanim::RigidParticles::MassProperties> &found);
  void follow_changes();
  void collect();

  std::map<int, mdanim::Inertia> given;    // by molecule IDs, from a file
  mdanim::ParticleValue lambda;
  bool has_drag = false;
  mdanim::RigidParticles particles;
  mdanim::RigidTouching touching;
  std::vector<mdanim::RigidBody> bodies;
  mdanim::GuidedBodies guided;
  mdanim::RigidGlue glue;
  mdanim::RigidSleep sleep;
  mdanim::RigidForces forces;
  std::vector<double> drag;                         // of bodies
  std::optional<mdanim::StateRecords> restarted;    // state of a restart file, until there are particles
  double half_dt = 0.0;                             // dt/2 in units that turn force/mass into velocity
  bool has_new_particles = false;                   // since bodies were made
  bool collected = false;                           // whether bodies have the forces of this step
  double drag_loss = 0.0;
};

}    // namespace LAMMPS_NS
