// SPDX-License-Identifier: GPL-2.0-only
// The forces on the particles of rigid bodies, and their torques about the centres, summed over each body.

#pragma once

#include "lammps/rigid_particles.h"
#include "rigid/body.h"

#include <array>
#include <vector>

namespace mdanim {

class RigidForces {
 public:
  using Sums = std::vector<std::array<double, 6>>;
  RigidForces(LAMMPS_NS::LAMMPS *lmp, const RigidParticles &particles, const std::vector<RigidBody> &bodies)
      : lmp(lmp), particles(particles), bodies(bodies)
  {
  }

  // Sums of all bodies. A body that is settled has those that it had, as long as each of its particles is pushed as before.
  const Sums &find();
  // To be called where particles or bodies are others than before, or in another order.
  void forget() { seen.clear(); }

 private:
  void look();

  LAMMPS_NS::LAMMPS *lmp;
  const RigidParticles &particles;
  const std::vector<RigidBody> &bodies;
  Sums sums;
  std::vector<double> seen;       // forces on local particles, where there is one rank, and some bodies are settled
  std::vector<char> as_before;    // of bodies
};

}    // namespace mdanim
