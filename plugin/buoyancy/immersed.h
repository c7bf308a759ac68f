// SPDX-License-Identifier: GPL-2.0-only
// The forces of a liquid on a particle in a step, for a double or all lanes of a vector unit at once (real.h). Wcislo 1999, sec.
// 4.3; docs/physics-liquid.md.

#pragma once

#include "buoyancy/law.h"
#include "buoyancy/liquid_scales.h"
#include "numbers/vec3.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

// The liquid where a particle is.
template <class Real> struct AtPlace {
  Real immersed{};    // fraction of the volume around it that is below the surface
  Vec<Real> push;     // force on a volume, divided by the weight of as much liquid
  Vec<Real> flow;     // velocity of the liquid [distance/time]
  Real rising{};      // upward velocity of the solid around [distance/time]
};

// The numbers of waves at a particle, from one update of the liquid to the next. A new one is a line here: rows of blocks,
// records and checks follow. EXACT numbers depend on where the basin stands; in memory the others have half the digits.
enum ExactNumber {
  BASE,    // base - slope z, within 0 and 1, is the fraction of the particle's volume below the surface
  SLOPE,
  EXACT_NUMBERS
};
enum SmallNumber {
  MORE,    // the push upwards is that fraction plus this
  ALONG_X,
  ALONG_Y,    // push sideways
  FLOW_X,
  FLOW_Y,    // velocity of the liquid [distance/time]
  RISING,    // see AtPlace
  SMALL_NUMBERS
};

template <class Real, class Small = Real> struct InWaves {
  Real exact[EXACT_NUMBERS] = {};
  Small small[SMALL_NUMBERS] = {};

  MDANIM_ALWAYS_INLINE AtPlace<Real> at(const Real &z) const
  {
    const Real part = smaller(larger(exact[BASE] - exact[SLOPE] * z, constant<Real>(0.0)), constant<Real>(1.0));
    return {part, {small[ALONG_X], small[ALONG_Y], part + small[MORE]}, {small[FLOW_X], small[FLOW_Y], Real{}}, small[RISING]};
  }
  // Nothing is below the surface, so flow and the solid's motion do not count: a push upwards is all, which may be 0.
  bool only_lifts() const { return exact[BASE] == 0 && exact[SLOPE] == 0 && small[ALONG_X] == 0 && small[ALONG_Y] == 0; }
  bool acts() const { return !only_lifts() || small[MORE] != 0; }
  bool is_finite() const
  {
    Real sum{};
    for (const Real &number : exact) sum += number;
    for (const Small &number : small) sum += number;
    return std::isfinite(sum);
  }
  InWaves<Real, float> rounded() const
  {
    InWaves<Real, float> of;
    std::copy_n(exact, EXACT_NUMBERS, of.exact);
    for (int k = 0; k < SMALL_NUMBERS; ++k) of.small[k] = static_cast<float>(small[k]);
    return of;
  }
};

// Values that are kept for a particle.
struct InLiquid {
  InWaves<double, float> waves;
  double impulse_x = 0.0, impulse_y = 0.0;    // on the liquid, over its density, since the last update
};

// The numbers of a particle in the liquid.
enum ParticleNumber {
  VOLUME,
  OWN_MASS,
  GAMMA,
  PER_LENGTH,    // of drag: rates [1/time], [1/distance]
  LAMBDA,        // friction that it has without the liquid
  LISTED,        // 1 near the liquid, else 0
  PARTICLE_NUMBERS
};

template <class Real> struct Immersed {
  Real of[PARTICLE_NUMBERS] = {};
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
  Vec<Real> push = lift_along(liquid, particle.of[VOLUME], at.push);
  const auto friction = [&](const Real &rate) {
    return liquid_lambda(rate, liquid.rho, particle.of[VOLUME], at.immersed) * liquid.per_force;
  };
  const Vec<Real> relative = v - at.flow;
  const Real lambda = friction(particle.of[GAMMA]);
  Real braking = lambda;
  if (liquid.quadratic) {
    const Real more = friction(particle.of[PER_LENGTH] * root(dot(relative, relative)));
    push -= more * relative;
    braking += more;
  }
  push += lambda * at.flow;
  const Real calmed = smaller(particle.of[OWN_MASS], constant<Real>(liquid.rho) * particle.of[VOLUME]);
  push.z -= (liquid.calming * at.immersed * calmed * liquid.per_force) * (v.z - at.rising);
  braking = liquid.impulse * braking;
  return {push, lambda, braking * relative.x, braking * relative.y};
}

}    // namespace mdanim
