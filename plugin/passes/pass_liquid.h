// SPDX-License-Identifier: GPL-2.0-only
// How a fix with a liquid takes part in passes over blocks (pass.h).

#pragma once

#include "buoyancy/immersed.h"
#include "passes/pass.h"

#include <functional>
#include <vector>

namespace mdanim {

class PassIntegrator;

// A liquid whose force on a particle depends on the particle's place and velocity and on a few numbers that are kept for it. A
// pass computes the force (buoyancy/immersed.h) and moves the particle at once. Particles that are held back for other
// participants are left to the fix, which is a late participant as well. Particles are numbered as in LAMMPS's arrays.
class PassLiquid {
 public:
  // Whether passes may compute the liquid's forces in this whole run.
  virtual bool joins(const PassIntegrator &integrator) = 0;
  virtual LiquidScales scales() const = 0;
  // Height below which a particle's speed counts.
  virtual double top_of_near() const = 0;
  // The particles near the liquid; listed() is another number when others are near.
  virtual const std::vector<int> &near_particles() const = 0;
  virtual long long listed() const = 0;
  virtual bool is_near(int i) const = 0;
  // Coefficients of a particle for passes; `lambda` is where the integrator reads friction, null without any. They hold until
  // particles move to other places of the arrays.
  virtual std::function<Immersed<double>(int i)> immersed(const double *lambda) const = 0;
  // Kept values of all particles in LAMMPS's arrays. Null where nothing is kept, and the part of a volume below the surface,
  // which alone acts, is looked up in each step: for `many` particles from `first` on in arrays of coordinates.
  virtual InLiquid *kept() = 0;
  virtual void parts_below(const double *const *x, int first, int many, double *part) const = 0;
  // From now on the arrays hold only these particles, until this is called again; null for all particles.
  virtual void split(const std::vector<int> *in_arrays) = 0;
  // Whether the liquid is to move in this step. If so, it moves before the pass, when the arrays hold all particles.
  virtual bool is_due() = 0;
  virtual void update_liquid() = 0;
  // Reports a pass that acted for the liquid: power of its forces without friction, and energy that friction takes; square of the
  // largest speed near the liquid, negative where no particle is near; wall time.
  virtual void acted(double work, double lost, double fastest, double seconds) = 0;

 protected:
  ~PassLiquid() = default;
};

}    // namespace mdanim
