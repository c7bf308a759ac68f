// SPDX-License-Identifier: GPL-2.0-only
// How a fix with a liquid takes part in passes over blocks (pass.h).

#ifndef MDANIM_PASS_LIQUID_H
#define MDANIM_PASS_LIQUID_H

#include "buoyancy/immersed.h"
#include "passes/pass.h"

#include <functional>
#include <vector>

namespace mdanim {

// A liquid whose force on a particle depends on the particle's place and velocity and on a few numbers that are kept for it: a
// pass computes it (buoyancy/immersed.h) and moves the particle at once. Particles that are held back for other participants are
// left to the fix, which is a late participant as well. Numbers of particles are those of LAMMPS's arrays.
class PassLiquid {
 public:
  // Whether passes may do that in this whole run; `lambda` is where the integrator reads friction.
  virtual bool joins(const double *lambda) = 0;
  virtual LiquidScales scales() const = 0;
  // Below this height a particle's speed counts.
  virtual double top_of_near() const = 0;
  // The particles near the liquid, and another number for others.
  virtual const std::vector<int> &near_particles() const = 0;
  virtual long long listed() const = 0;
  virtual bool is_near(int i) const = 0;
  // What passes are told of a particle, until particles move to other places of the arrays.
  virtual std::function<ImmersedMover(int i)> immersed() const = 0;
  // Of all particles in LAMMPS's arrays.
  virtual InLiquid *kept() = 0;
  // The arrays hold these particles alone from now on, until this is called again; null for all particles.
  virtual void split(const std::vector<int> *in_arrays) = 0;
  // Whether the liquid is to move in this step. If so it does before the pass, when the arrays hold all particles.
  virtual bool is_due() = 0;
  virtual void update_liquid() = 0;
  // By a pass in its name: power of its forces without friction's, and what friction takes; square of the largest speed of what
  // is near after it, negative for nothing.
  virtual void acted(double work, double lost, double fastest, double seconds) = 0;

 protected:
  ~PassLiquid() = default;
};

}    // namespace mdanim

#endif
