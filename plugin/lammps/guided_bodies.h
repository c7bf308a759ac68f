// SPDX-License-Identifier: GPL-2.0-only
// Rigid bodies that fix mdanim/drive moves, until it lets them go.

#pragma once

#include "lammps/rigid_particles.h"
#include "lammps/rigid_touching.h"
#include "rigid/body.h"

#include <vector>

namespace mdanim {

class GuidedBodies {
 public:
  GuidedBodies(const RigidParticles &particles, RigidTouching &touching, std::vector<RigidBody> &bodies)
      : particles(particles), touching(touching), bodies(bodies)
  {
  }

  // Finds those of this step. One that has been let go brings its energy of motion; half_dt and drag are as in RigidBody.
  void find(double half_dt, const std::vector<double> &drag);
  // To their places at the end of the step, with the mean velocities of the step.
  void move(double dt);
  // Velocities at whole steps: the mean of the step that ends here and the next one.
  void set_whole_motion(double dt);
  // Contact at the end of a step. Its work on them is that of the mean of the pushes before and after, with the mean velocity of
  // the step, which they have here.
  void touch(double dt);

 private:
  int id(std::size_t n) const { return static_cast<int>(particles.objects().id(static_cast<int>(n))); }
  template <class Function> void each(const Function &function) const
  {
    for (std::size_t n = 0; n < bodies.size(); ++n)
      if (bodies[n].guided) function(n);
  }

  const RigidParticles &particles;
  RigidTouching &touching;
  std::vector<RigidBody> &bodies;
};

}    // namespace mdanim
