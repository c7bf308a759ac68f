// SPDX-License-Identifier: GPL-2.0-only
// A point of an object's surface that is in contact with a plane. Plain data; simd/of_set.h says why.

#pragma once

#include "contact/law.h"

#include <cstdint>

namespace mdanim {

// Values that a contact brings from the step before and that change in it.
template <class Real> struct PlaneState {
  Vec<Real> anchor;    // [m]
  ContactMemory<Real> memory;
};

struct PlaneContact {
  std::int32_t point, plane;
  PlaneState<double> state;
};

// Results for a contact in a step; where the depth is not above 0 the contact is over, and stays as it is.
template <class Real> struct PlanePush {
  Vec<Real> force;    // on the point
  Real depth{}, energy{}, heat{}, damped{}, unused{};
};

// A point at x, `depth` below the plane, whose gradient is `downward`.
template <class Real>
MDANIM_ALWAYS_INLINE PlanePush<Real> push_at_plane(const ContactLaw &law, double dt, const Real &area, const Vec<Real> &downward,
                                                   const Vec<Real> &x, const Real &depth, PlaneState<Real> &state)
{
  const Real whole = constant<Real>(1.0);
  ContactForce<Real> force = contact_pressure(law, area, whole, depth, dt, state.memory);
  if (law.friction > 0.0) {
    Vec<Real> away = x - state.anchor;
    away -= dot(away, downward) * downward;
    contact_friction(law, area, whole, away, downward, dt, state.memory, force);
    state.anchor = x - force.kept * away;
  }
  PlanePush<Real> push;
  push.force = -force.press * downward + force.pull + force.drag;
  push.depth = depth, push.energy = force.surface_energy, push.heat = force.heat, push.damped = force.damped;
  return push;
}

}    // namespace mdanim
