// SPDX-License-Identifier: GPL-2.0-only
// The motion of a block that a liquid acts on.

#pragma once

#include "passes/pass_kernel.h"

namespace mdanim {
namespace {

typedef float Floats __attribute__((vector_size(4 * LANES)));

MDANIM_ALWAYS_INLINE Vector load_floats(const float *from) { return __builtin_convertvector(load<Floats>(from), Vector); }

// The law is liquid_force() of buoyancy/immersed.h. Not inlined: most blocks are dry.
template <Friction FRICTION, bool DAMPED>
__attribute__((noinline)) void move_immersed(const Pass &pass, const Block &block, const double *total, Tally &tally)
{
  const double *const motion = pass.motion + static_cast<unsigned long>(block.motion) * (MOTIONS * LANES);
  const ImmersedRows &rows = pass.immersed;
  double *const kept = rows.kept + static_cast<long>(block.immersed) * (KEPT_NUMBERS * LANES);
  const float *const small = rows.small + static_cast<long>(block.immersed) * (SMALL_NUMBERS * LANES);
  const double *const own =
      rows.particle + static_cast<unsigned long>(rows.particles[block.immersed]) * (PARTICLE_NUMBERS * LANES);
  InWaves<Vector> waves;
  for (int k = 0; k < EXACT_NUMBERS; ++k) waves.exact[k] = load(kept + k * LANES);
  for (int k = 0; k < SMALL_NUMBERS; ++k) waves.small[k] = load_floats(small + k * LANES);
  Immersed<Vector> particle;
  for (int k = 0; k < PARTICLE_NUMBERS; ++k) particle.of[k] = load(own + k * LANES);
  const AtPlace<Vector> at = waves.at(load(pass.x[2] + block.start));
  const auto force = liquid_force(rows.liquid, particle, at, load(pass.v, block.start));
  store(kept + IMPULSE_X * LANES, load(kept + IMPULSE_X * LANES) + force.impulse_x);
  store(kept + IMPULSE_Y * LANES, load(kept + IMPULSE_Y * LANES) + force.impulse_y);
  const Vector kick = load(motion + KICK * LANES), phi = (particle.of[LAMBDA] + force.lambda) * kick;
  tally.largest_phi = larger(phi, tally.largest_phi);
  const auto then = [&](const Vector3 &middle, const Vector3 &last, const Vector3 &place) {
    add_lanes(tally.sums.liquid_work, dot(force.push, middle));
    add_lanes(tally.sums.liquid_lost, force.lambda * dot(middle, middle));
    const Vector square = particle.of[LISTED] > 0.0 ? dot(last, last) : constant<Vector>(-1.0);
    tally.fastest_near = place.z < rows.top_of_near ? larger(square, tally.fastest_near) : tally.fastest_near;
  };
  const Vector mass = phi > 0.0 ? particle.of[OWN_MASS] : Vector{};
  advance<FRICTION, DAMPED>(pass, block, total, load_own(total) + force.push, half_steps<FRICTION>(phi, kick), mass, tally, then);
}

}    // namespace
}    // namespace mdanim
