// SPDX-License-Identifier: GPL-2.0-only
// What liquid does to a particle in a step, for a double or all lanes of a vector unit at once (real.h). Wcislo 1999, sec. 4.3;
// docs/physics-liquid.md.

#ifndef MDANIM_IMMERSED_H
#define MDANIM_IMMERSED_H

#include "laws/buoyancy.h"
#include "laws/liquid_scales.h"
#include "laws/vec3.h"

namespace mdanim {

// The liquid where a particle is.
template <class Real> struct AtPlace {
  Real immersed{};    // part of the volume around it that is below the surface
  Vec<Real> push;     // force on a volume, over the weight of as much liquid
  Vec<Real> flow;     // velocity of the liquid [distance/time]
  Real rising{};      // upward velocity of the solid around [distance/time]
};

// Waves at a particle, from one update of the liquid to the next.
template <class Real> struct InWaves {
  Real base{}, slope{};         // the part of its volume below the surface is base - slope z, within 0 and 1
  Real more{};                  // the push upwards is that part and this
  Real along_x{}, along_y{};    // push sideways
  Real flow_x{}, flow_y{};      // velocity of the liquid
  Real rising{};                // see AtPlace

  MDANIM_ALWAYS_INLINE AtPlace<Real> at(const Real &z) const
  {
    const Real part = smaller(larger(base - slope * z, constant<Real>(0.0)), constant<Real>(1.0));
    return {part, {along_x, along_y, part + more}, {flow_x, flow_y, Real{}}, rising};
  }
};

// A particle.
template <class Real> struct Immersed {
  Real volume, mass;
  Real gamma, per_length;    // of drag: rates [1/time], [1/distance]
};

template <class Real> struct LiquidForce {
  Vec<Real> push;
  Real lambda;                  // friction, which the integrator adds
  Real impulse_x, impulse_y;    // on the liquid, over its density
};

// Archimedes' push, over the parts of the weight of as much liquid along each axis.
template <class Real>
MDANIM_ALWAYS_INLINE Vec<Real> lift_along(const LiquidScales &liquid, const Real &volume, const Vec<Real> &part)
{
  const auto along = [&](const Real &s) { return lift(liquid.rho, volume, s, liquid.g); };
  return {along(part.x), along(part.y), along(part.z)};
}

// A particle with velocity v that pressure pushes. Drag is against the liquid, not against the floor: its friction, which is
// against the floor, is made up for by a push along the flow. Quadratic drag is a force, as forces are a part of the state and
// friction is not: friction that depends on positions alone is found again.
template <class Real>
MDANIM_ALWAYS_INLINE LiquidForce<Real> liquid_force(const LiquidScales &liquid, const Immersed<Real> &particle,
                                                    const AtPlace<Real> &at, Vec<Real> push, const Vec<Real> &v)
{
  const auto friction = [&](const Real &rate) {
    return liquid_lambda(rate, liquid.rho, particle.volume, at.immersed) * liquid.per_force;
  };
  const Vec<Real> relative = v - at.flow;
  const Real lambda = friction(particle.gamma);
  Real braking = lambda;
  if (liquid.quadratic) {
    const Real more = friction(particle.per_length * root(dot(relative, relative)));
    push -= more * relative;
    braking += more;
  }
  push += lambda * at.flow;
  push.z -= (liquid.calming * at.immersed * particle.mass * liquid.per_force) * (v.z - at.rising);
  braking = liquid.impulse * braking;
  return {push, lambda, braking * relative.x, braking * relative.y};
}

}    // namespace mdanim

#endif
