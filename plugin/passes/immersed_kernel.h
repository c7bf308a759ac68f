// SPDX-License-Identifier: GPL-2.0-only
// The motion of a block that a liquid acts on.

#pragma once

#include "passes/pass_kernel.h"

#include <utility>

namespace mdanim {
namespace {

// Built at once: numbers that are set one by one are cleared in memory first.
template <int MANY> using Numbers = std::make_integer_sequence<int, MANY>;

template <int... EXACT, int... SMALL>
MDANIM_ALWAYS_INLINE InWaves<Vector> load_waves(const double *exact, const float *small, std::integer_sequence<int, EXACT...>,
                                                std::integer_sequence<int, SMALL...>)
{ return {{load(exact + EXACT * LANES)...}, {load_floats(small + SMALL * LANES)...}}; }

template <int... NUMBER>
MDANIM_ALWAYS_INLINE Immersed<Vector> load_particle(const double *from, std::integer_sequence<int, NUMBER...>)
{ return {{load(from + NUMBER * LANES)...}}; }

// Speeds near the liquid.
MDANIM_ALWAYS_INLINE void note_speed(const Pass &pass, const double *particle, const Vector3 &last, const Vector3 &place,
                                     Tally &tally)
{
  const Vector square = load(particle + LISTED * LANES) > 0.0 ? dot(last, last) : constant<Vector>(-1.0);
  tally.fastest_near = place.z < pass.immersed.top_of_near ? larger(square, tally.fastest_near) : tally.fastest_near;
}

// A block above the surface, with at most the push of the liquid that its body takes along: liquid_force() without its zeros.
template <Friction FRICTION, bool DAMPED>
__attribute__((noinline)) void move_lifted(const Pass &pass, const Block &block, const double *total, Tally &tally)
{
  const ImmersedRows &rows = pass.immersed;
  const double *const particle =
      rows.particle + static_cast<unsigned long>(rows.particles[block.immersed]) * (PARTICLE_NUMBERS * LANES);
  const Vector more = load_floats(rows.small + (static_cast<long>(block.immersed) * SMALL_NUMBERS + MORE) * LANES);
  const Vector push = lift(rows.liquid.rho, load(particle + VOLUME * LANES), more, rows.liquid.g);
  Vector3 force = load_own(total);
  force.z += push;
  const auto then = [&](const Vector3 &middle, const Vector3 &last, const Vector3 &place) {
    add_lanes(tally.sums.liquid_work, push * middle.z);
    note_speed(pass, particle, last, place, tally);
  };
  const Vector kick = load(pass.motion + (static_cast<unsigned long>(block.motion) * MOTIONS + KICK) * LANES);
  const Vector phi = load(particle + LAMBDA * LANES) * kick;
  if (!any_lane(phi > 0.0))
    return advance<Friction::NONE, DAMPED>(pass, block, force, Frictionless<Vector>{kick}, Vector{}, tally, then);
  tally.largest_phi = larger(phi, tally.largest_phi);
  const Vector mass = phi > 0.0 ? load(particle + OWN_MASS * LANES) : Vector{};
  advance<FRICTION, DAMPED>(pass, block, force, half_steps<FRICTION>(phi, kick), mass, tally, then);
}

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
  const auto waves = load_waves(kept, small, Numbers<EXACT_NUMBERS>(), Numbers<SMALL_NUMBERS>());
  const auto particle = load_particle(own, Numbers<PARTICLE_NUMBERS>());
  const AtPlace<Vector> at = waves.at(load(pass.x[2] + block.start));
  const auto force = liquid_force(rows.liquid, particle, at, load(pass.v, block.start));
  store(kept + IMPULSE_X * LANES, load(kept + IMPULSE_X * LANES) + force.impulse_x);
  store(kept + IMPULSE_Y * LANES, load(kept + IMPULSE_Y * LANES) + force.impulse_y);
  const Vector kick = load(motion + KICK * LANES), phi = (particle.of[LAMBDA] + force.lambda) * kick;
  tally.largest_phi = larger(phi, tally.largest_phi);
  const auto then = [&](const Vector3 &middle, const Vector3 &last, const Vector3 &place) {
    add_lanes(tally.sums.liquid_work, dot(force.push, middle));
    add_lanes(tally.sums.liquid_lost, force.lambda * dot(middle, middle));
    note_speed(pass, own, last, place, tally);
  };
  const Vector mass = phi > 0.0 ? particle.of[OWN_MASS] : Vector{};
  advance<FRICTION, DAMPED>(pass, block, load_own(total) + force.push, half_steps<FRICTION>(phi, kick), mass, tally, then);
}

}    // namespace
}    // namespace mdanim
