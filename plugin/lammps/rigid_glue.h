// SPDX-License-Identifier: GPL-2.0-only
// Glue between the bodies of fix mdanim/rigid: its file, and what breaks in a step.

#pragma once

#include "lammps/object_table.h"
#include "lammps/rigid_particles.h"
#include "lammps/rigid_touching.h"
#include "rigid/glued_bodies.h"

#include <string>
#include <vector>

namespace mdanim {

class RigidGlue {
 public:
  RigidGlue(const RigidParticles &particles, RigidTouching &touching, std::vector<RigidBody> &bodies)
      : particles(particles), touching(touching), bodies(bodies)
  {
  }

  GluedBodies glued;

  // Reads the file of faces. Throws std::runtime_error.
  void read(const char *file, const std::string &text) { faces = read_glue(file, text); }
  std::vector<Output> outputs(const double &mvv2e);
  double torn_energy() const { return torn; }    // in units of mass times velocity squared
  void forget() { glued = GluedBodies(); }
  // Numbers the bodies of faces, once. Throws std::runtime_error.
  void take();
  // The same, and pieces as they are now move as one body, where glue holds them together.
  void join();
  // Tells contact how pieces are glued.
  void tell_contact();
  // Kinetic energy of bodies, and of wholes in place of the pieces that are glued into them.
  double kinetic(double half_dt, const std::vector<double> &drag) const;
  // At the end of a step, with the velocities of whole steps: breaks glue. `collect` finds the forces of the next one, which are
  // those of the pieces.
  template <class Collect>
  void break_some(double to_acceleration, double half_dt, const std::vector<double> &drag, const Collect &collect)
  {
    const std::vector<int> apart = judge(to_acceleration, half_dt);
    if (apart.empty()) return;
    collect();
    for (const int n : apart) torn -= kinetic_of(n, half_dt, drag);
  }

 private:
  std::vector<int> judge(double to_acceleration, double half_dt);
  double kinetic_of(int body, double half_dt, const std::vector<double> &drag) const;

  const RigidParticles &particles;
  RigidTouching &touching;
  std::vector<RigidBody> &bodies;
  std::vector<GlueFace> faces;    // as the file has them
  double torn = 0.0;              // energy of contacts and motion that was lost where glue broke
};

}    // namespace mdanim
