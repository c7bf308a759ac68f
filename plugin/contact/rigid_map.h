// SPDX-License-Identifier: GPL-2.0-only
// The map from lattice coordinates X of a body that does not deform to places in space, by four of its particles.
//   x(X) = sum_k w_k(X) x_k,   w_k(X) = b_k + G_k . X      weights sum to 1 and reproduce X
// It is exact wherever the particles have moved together, with + - x / alone. Forces that are spread by the same weights keep
// momentum and angular momentum.
// Templates over Real (numbers/real.h), compiled for every set of instructions (contact_kernel_of_set.cpp).

#pragma once

#include "contact/lattice_map.h"
#include "contact/padded_vec3.h"

namespace mdanim {

struct RigidFrame {
  static constexpr int PARTICLES = 4;
  int particle[PARTICLES];      // their numbers in the body, ascending
  double at_zero[PARTICLES];    // b
  Vec3 slope[PARTICLES];        // G

  template <class Real> MDANIM_ALWAYS_INLINE Real weight(int k, const Vec<Real> &X) const
  { return at_zero[k] + (slope[k].x * X.x + slope[k].y * X.y + slope[k].z * X.z); }
};

// The place of a rigid object: x(X) at X = 0 and its gradient.
MDANIM_ALWAYS_INLINE void evaluate_frame(const RigidFrame &frame, const Vec3 (&place)[RigidFrame::PARTICLES], Spot<double> &spot)
{
  spot.x = place[0];
  spot.J[0] = spot.J[1] = spot.J[2] = Vec3{};
  for (int k = 1; k < RigidFrame::PARTICLES; ++k) {
    const Vec3 side = place[k] - place[0];    // small numbers: weights of the place itself would add up its rounding
    spot.x += frame.at_zero[k] * side;
    spot.J[0] += frame.slope[k].x * side;
    spot.J[1] += frame.slope[k].y * side;
    spot.J[2] += frame.slope[k].z * side;
  }
  spot.invert();
}

// Calls on(k, force w_k + dw_k/dX . moment) for every particle of the frame.
template <class Real, class On>
MDANIM_ALWAYS_INLINE void spread_to_frame(const RigidFrame &frame, const Vec<Real> &X, const Vec<Real> &force,
                                          const Vec<Real> (&moment)[3], const On &on)
{
  for (int k = 0; k < RigidFrame::PARTICLES; ++k)
    on(k,
       frame.weight(k, X) * force + (frame.slope[k].x * moment[0] + frame.slope[k].y * moment[1] + frame.slope[k].z * moment[2]));
}

}    // namespace mdanim
