// SPDX-License-Identifier: GPL-2.0-only
// The forces of a liquid on a particle in a step, for a double or all lanes of a vector unit at once (real.h). Wcislo 1999, sec.
// 4.3; docs/physics-liquid.md.

#pragma once

#include "buoyancy/law.h"
#include "buoyancy/liquid_scales.h"
#include "numbers/vec3.h"

#include <cmath>

namespace mdanim {

// The liquid where a particle is.
template <class Real> struct AtPlace {
  Real immersed{};    // fraction of the volume around it that is below the surface
  Vec<Real> push;     // force on a volume, divided by the weight of as much liquid
  Vec<Real> flow;     // velocity of the liquid [distance/time]
  Real rising{};      // upward velocity of the solid around [distance/time]
};

// Waves at a particle, from one update of the liquid to the next. In memory, numbers that do not depend on where the basin stands
// have half the digits.
template <class Real, class Small = Real> struct InWaves {
  Real base{}, slope{};          // the fraction of its volume below the surface is base - slope z, within 0 and 1
  Small more{};                  // the push upwards is that fraction plus this
  Small along_x{}, along_y{};    // push sideways
  Small flow_x{}, flow_y{};      // velocity of the liquid
  Small rising{};                // see AtPlace

  MDANIM_ALWAYS_INLINE AtPlace<Real> at(const Real &z) const
  {
    const Real part = smaller(larger(base - slope * z, constant<Real>(0.0)), constant<Real>(1.0));
    return {part, {along_x, along_y, part + more}, {flow_x, flow_y, Real{}}, rising};
  }
  bool acts() const { return base != 0 || slope != 0 || more != 0 || along_x != 0 || along_y != 0; }
  bool is_finite() const { return std::isfinite(base + slope + more + along_x + along_y + flow_x + flow_y + rising); }
  InWaves<Real, float> rounded() const
  {
    const auto round = [](Real of) { return static_cast<float>(of); };
    return {base, slope, round(more), round(along_x), round(along_y), round(flow_x), round(flow_y), round(rising)};
  }
};

// Values that are kept for a particle.
struct InLiquid {
  InWaves<double, float> waves;
  double impulse_x = 0.0, impulse_y = 0.0;    // on the liquid, over its density, since the last update
};

// A particle in the liquid.
template <class Real> struct Immersed {
  Real volume, mass;
  Real gamma, per_length;    // of drag: rates [1/time], [1/distance]
};

template <class Real> struct LiquidForce {
  Vec<Real> push;
  Real lambda;                  // friction, which the integrator adds
  Real impulse_x, impulse_y;    // on the liquid, over its density
};

// Archimedes' force, divided by the weight of as much liquid, along each axis.
template <class Real>
MDANIM_ALWAYS_INLINE Vec<Real> lift_along(const LiquidScales &liquid, const Real &volume, const Vec<Real> &part)
{
  const auto along = [&](const Real &s) { return lift(liquid.rho, volume, s, liquid.g); };
  return {along(part.x), along(part.y), along(part.z)};
}

// Lift and drag on a particle with velocity v. Drag acts relative to the liquid, not to the floor: friction acts relative to the
// floor, and a push along the flow makes up the difference. Quadratic drag is a force, because forces are a part of the state and
// friction is not: friction that depends on positions alone can be computed again.
template <class Real>
MDANIM_ALWAYS_INLINE LiquidForce<Real> liquid_force(const LiquidScales &liquid, const Immersed<Real> &particle,
                                                    const AtPlace<Real> &at, const Vec<Real> &v)
{
  Vec<Real> push = lift_along(liquid, particle.volume, at.push);
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
  const Real calmed = smaller(particle.mass, constant<Real>(liquid.rho) * particle.volume);
  push.z -= (liquid.calming * at.immersed * calmed * liquid.per_force) * (v.z - at.rising);
  braking = liquid.impulse * braking;
  return {push, lambda, braking * relative.x, braking * relative.y};
}

}    // namespace mdanim
