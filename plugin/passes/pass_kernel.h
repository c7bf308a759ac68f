// SPDX-License-Identifier: GPL-2.0-only
// The pass over a range of blocks (pass.h), for vectors of MDANIM_LANES doubles.
//
// Springs are evaluated once. Blocks come in ascending order and in each of them offsets in descending order, so that a particle
// receives from its lower partners in ascending order, and a block's own sum takes its upper ones in descending order: the order
// of springs/row_forces.cpp, hence its bits, as the laws are the same text. Lanes without a spring have push = pull = 0 and add
// nothing as long as positions are finite: F = 0, and a sum that starts at +0 is never -0. Positions of a block can move on at
// once, for all that is still to come reads its own and upper ones.

#pragma once

#include "leapfrog/law.h"
#include "passes/plane_kernel.h"
#include "passes/spring_kernel.h"

#include <sched.h>

namespace mdanim {
namespace {

MDANIM_ALWAYS_INLINE Vector largest(Vector a, Vector b) { return a > b ? a : b; }

// Adds lanes in the order of particles, whatever the number of lanes.
MDANIM_ALWAYS_INLINE void add_lanes(double &sum, const Vector &lanes)
{
  double each[LANES];
  store(each, lanes);
  for (int lane = 0; lane < LANES; ++lane) sum += each[lane];
}

// Largest and smallest coordinates of one object, collected lane by lane.
struct Bounds {
  Vector low[3], high[3];

  MDANIM_ALWAYS_INLINE void open()
  {
    for (Vector &b : low) b = Vector{} + __DBL_MAX__;
    for (Vector &b : high) b = Vector{} - __DBL_MAX__;
  }
  MDANIM_ALWAYS_INLINE void include(const Vector3 &x)
  {
    const Vector at[] = {x.x, x.y, x.z};
    for (int d = 0; d < 3; ++d) {
      low[d] = at[d] < low[d] ? at[d] : low[d];
      high[d] = at[d] > high[d] ? at[d] : high[d];
    }
  }
  MDANIM_ALWAYS_INLINE void close(double *box) const    // of boxes.h
  {
    for (int d = 0; d < 3; ++d)
      for (int lane = 0; lane < LANES; ++lane) {
        if (low[d][lane] < box[d]) box[d] = low[d][lane];
        if (-high[d][lane] < box[3 + d]) box[3 + d] = -high[d][lane];
      }
  }
};

// Results of a pass, returned at its end.
struct Tally {
  Vector fastest{}, squares{};
  Vector fastest_near = constant<Vector>(-1.0), largest_phi{};
  PassSums sums{};
  int chunk = -1;    // whose sums these are
  Bounds box;
  Vector fastest_of_object{};
  int object = -1;    // whose box and speed these are

  MDANIM_ALWAYS_INLINE void turn_to_chunk(int next, const Pass &pass)
  {
    if (chunk >= 0) pass.sums[chunk] = sums;
    sums = {};
    chunk = next;
  }

  MDANIM_ALWAYS_INLINE void turn_to_object(int next, const Pass &pass)
  {
    if (object >= 0) {
      double *row = pass.trace + TRACE * object;
      for (int side = 0; side < 2; ++side)
        if (object == pass.range->shared[side]) row = pass.range->shared_trace + TRACE * side;
      if (pass.looks) box.close(row);
      for (int lane = 0; lane < LANES; ++lane)
        if (-fastest_of_object[lane] < row[FASTEST]) row[FASTEST] = -fastest_of_object[lane];
      fastest = largest(fastest_of_object, fastest);
    }
    box.open();
    fastest_of_object = Vector{};
    object = next;
  }
};

// The law of leapfrog/law.h with the coefficients in a row of Pass::motion.
template <Friction FRICTION> MDANIM_ALWAYS_INLINE auto half_steps(const double *motion)
{
  if constexpr (FRICTION == Friction::IMPLICIT)
    return Implicit<Vector>{load(motion + PHI * LANES), load(motion + KICK * LANES), load(motion + STAY * LANES),
                            load(motion + SHARE * LANES)};
  else if constexpr (FRICTION == Friction::EXPONENTIAL)
    return Exponential<Vector>{load(motion + STAY * LANES), load(motion + PUSH * LANES), load(motion + KICK * LANES)};
  else
    return Frictionless<Vector>{load(motion + KICK * LANES)};
}

// The same law with a phi of this step.
template <Friction FRICTION> MDANIM_ALWAYS_INLINE auto half_steps(const Vector &phi, const Vector &kick)
{
  if constexpr (FRICTION == Friction::IMPLICIT)
    return Implicit<Vector>::of(phi, kick);
  else
    return Exponential<Vector>::of(phi, kick);
}

// The second half of a step and the first half of the next, by a law of leapfrog/law.h; friction takes from `mass` only.
// then(v^n, v^{n+1/2}, r^{n+1}) is called with the sums of the block's chunk.
template <Friction FRICTION, bool DAMPED, class Law, class Then>
MDANIM_ALWAYS_INLINE void advance(const Pass &pass, const Block &block, const Vector3 &f, const Law &law, const Vector &mass,
                                  Tally &tally, const Then &then)
{
  const int i = block.start;
  const double *const motion = pass.motion + static_cast<unsigned long>(block.motion) * (MOTIONS * LANES);
  const Vector dt = load(motion + DT * LANES);
  const Vector3 first = load(pass.v, i);
  const Vector3 middle = law.final_half(first, f), last = law.first_half(middle, f);
  Vector3 place = load(pass.x, i) + dt * last;
  store(pass.v, i, last);
  store(pass.x, i, place);
  Vector square = dot(last, last);
  tally.squares += square;
  if (pass.bends) add_lanes(tally.sums.bend, dt * dot(last, f));
  if (__builtin_expect(pass.gravity.works, 0)) {
    const Vector mass = load(motion + OWNED_LANE * LANES) * load(motion + MASS * LANES);
    add_lanes(tally.sums.pulled,
              mass * (pass.gravity.both[0] * first.x + pass.gravity.both[1] * first.y + pass.gravity.both[2] * first.z));
  }
  if (DAMPED && block.damped) store(pass.seen, i, first);    // lanes of others come later
  if constexpr (FRICTION != Friction::NONE) {                // 0 in lanes of others
    add_lanes(tally.sums.loss, law.loss_of_step(first, middle, last, f, mass));
  }
  then(middle, last, place);
  if (pass.trace) {
    if (block.object != tally.object) tally.turn_to_object(block.object, pass);
    if (block.lanes < LANES) {    // lanes of others are put where the first one is, at rest
      const Vector others = load(motion + FOREIGN_LANE * LANES);
      const auto at_first = [&](const Vector &a) { return others > 0.0 ? Vector{} + a[0] : a; };
      place = {at_first(place.x), at_first(place.y), at_first(place.z)};
      square = others > 0.0 ? Vector{} : square;
    }
    if (pass.looks) tally.box.include(place);
    tally.fastest_of_object = largest(square, tally.fastest_of_object);
  } else {
    if (block.lanes < LANES) square = load(motion + FOREIGN_LANE * LANES) > 0.0 ? Vector{} : square;
    tally.fastest = largest(square, tally.fastest);
  }
}

// The same in a liquid, and above its surface (immersed_kernel.h).
template <Friction FRICTION, bool DAMPED>
void move_immersed(const Pass &pass, const Block &block, const double *total, Tally &tally);
template <Friction FRICTION, bool DAMPED>
void move_lifted(const Pass &pass, const Block &block, const double *total, Tally &tally);

template <Friction FRICTION, bool DAMPED>
MDANIM_ALWAYS_INLINE void move(const Pass &pass, const Block &block, const double *total, Tally &tally)
{
  const double *const motion = pass.motion + static_cast<unsigned long>(block.motion) * (MOTIONS * LANES);
  if (block.chunk != tally.chunk) tally.turn_to_chunk(block.chunk, pass);
  if (DAMPED && block.damped) {    // springs of a ghost's lane are told by the rank that it belongs to
    const Vector counts = load(motion + OWNED_LANE * LANES);
    add_lanes(tally.sums.dashpots.work, counts * load(total + 3 * LANES));
    add_lanes(tally.sums.dashpots.bend, counts * load(total + 4 * LANES));
  }
  if (block.held_back) {
    for (int lane = 0; lane < block.lanes; ++lane)
      for (int d = 0; d < 3; ++d) pass.total[3 * (block.start + lane) + d] = total[d * LANES + lane];
    return;
  }
  if constexpr (FRICTION != Friction::NONE) {
    if (__builtin_expect(block.immersed >= 0, 0)) {
      block.only_lifted ? move_lifted<FRICTION, DAMPED>(pass, block, total, tally)
                        : move_immersed<FRICTION, DAMPED>(pass, block, total, tally);
      return;
    }
  }
  advance<FRICTION, DAMPED>(pass, block, load_own(total), half_steps<FRICTION>(motion), load(motion + BRAKED_MASS * LANES), tally,
                            [](const Vector3 &, const Vector3 &, const Vector3 &) {});
}

// --- at the borders of ranges ---

// Lanes of particles from i on. Those of another range, which another thread may be moving, are put where the first is.
MDANIM_ALWAYS_INLINE Vector3 load_before(int end, double *const *from, int i)
{
  if (__builtin_expect(i + LANES <= end, 1)) return load(from, i);
  double lanes[3 * LANES];
  for (int d = 0; d < 3; ++d)
    for (int lane = 0; lane < LANES; ++lane) lanes[d * LANES + lane] = from[d][i + lane < end ? i + lane : i];
  return load_own(lanes);
}

MDANIM_ALWAYS_INLINE bool is_pushed(const Block &block) { return block.external_force >= 0 || block.planes >= 0; }

// Adds the forces that a participant has given, and clears them for the next pass while they are in the cache. Many are 0.
MDANIM_ALWAYS_INLINE void take_given(double *of_fix, double *total)
{
  const Vector3 force = load_own(of_fix);
  if (!any_lane((force.x != 0.0) | (force.y != 0.0) | (force.z != 0.0))) return;
  store_own(total, load_own(total) + force);
  store_own(of_fix, Vector3{});
}

// Adds the forces of participants: those that they have given, and those of their planes. Not inlined: most blocks have none, and
// the springs need all registers.
__attribute__((noinline)) void take_external_force(const Pass &pass, const Block &block, double *total)
{
  double *const given =
      block.external_force >= 0 ? pass.external_force + static_cast<long>(block.external_force) * (3 * LANES) : nullptr;
  if (block.planes < 0) {
    for (int n = 0; n < pass.force_providers; ++n) take_given(given + n * (3 * LANES), total);
    return;
  }
  const PlaneRow *row = pass.planes.row + block.planes;
  const Vector3 x = block.at_border ? load_before(pass.range->end, pass.x, block.start) : load(pass.x, block.start);
  for (int n = 0; n < pass.force_providers; ++n) {
    if (row && row->provider == n) {
      pass.planes.law[row->law].law.friction > 0.0 ? push_with_friction(pass.planes, row, x, total)
                                                   : push_without_friction(pass.planes, row, x, total);
      while (row && row->provider == n) row = row->is_last ? nullptr : row + 1;
    } else if (given) {
      take_given(given + n * (3 * LANES), total);
    }
  }
}

template <bool DAMPED> MDANIM_ALWAYS_INLINE void cross(const Pass &pass, const Border &border)
{
  const auto place = [](double *const *from, int i) { return load(from, i); };
  unsigned e = border.first_entry;
  for (int n = border.first; n < border.first + border.crossings; ++n) {
    const Crossing &block = pass.crossing[n];
    Felt felt{};
    if (DAMPED && block.damped)
      add_springs<true>(pass, pass.crossing_entry, e, block.end, block.rates, block.start, border.f, felt, place);
    else
      add_springs<false>(pass, pass.crossing_entry, e, block.end, block.rates, block.start, border.f, felt, place);
    felt.put<DAMPED>(pass.crossed + static_cast<long>(n) * (FELT<DAMPED> * LANES));
  }
}

// Springs across a border have been evaluated when this returns, by whichever thread came first. That thread waits for no other,
// so no thread waits long.
template <bool DAMPED> __attribute__((noinline)) void see_crossed(const Pass &pass, Border &border)
{
  unsigned before = pass.turn - 1;
  if (__atomic_compare_exchange_n(&border.claimed, &before, pass.turn, false, __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE)) {
    cross<DAMPED>(pass, border);
    __atomic_store_n(&border.crossed, pass.turn, __ATOMIC_RELEASE);
    return;
  }
  while (__atomic_load_n(&border.crossed, __ATOMIC_ACQUIRE) != pass.turn) sched_yield();
}

// A block of a damped pass, which may itself be damped or not.
template <bool DAMPED_PASS, bool DAMPED>
__attribute__((noinline)) void feel_at_border(const Pass &pass, const Block &block, unsigned &e, double *total)
{
  Felt felt{};
  if (block.crossing >= 0) {
    see_crossed<DAMPED_PASS>(pass, *pass.range->above);
    felt = Felt::from<DAMPED>(pass.crossed + static_cast<long>(block.crossing) * (FELT<DAMPED_PASS> * LANES));
  }
  const auto place = [end = pass.range->end](double *const *from, int i) { return load_before(end, from, i); };
  add_springs<DAMPED>(pass, pass.entry, e, block.end, block.rates, block.start, pass.range->f, felt, place);
  add_up<DAMPED>(pass, block, felt, total);
}

// The same in a copy of its own lanes.
template <Friction FRICTION, bool DAMPED>
__attribute__((noinline)) void move_at_border(const Pass &pass, const Block &block, const double *total, Tally &tally)
{
  constexpr int KINDS = DAMPED ? 3 : 2;
  double room[KINDS][3][LANES] = {};
  Pass copy = pass;
  double **const of_copy[] = {copy.x, copy.v, copy.seen};
  for (int kind = 0; kind < KINDS; ++kind)
    for (int d = 0; d < 3; ++d) {
      for (int lane = 0; lane < block.lanes; ++lane) room[kind][d][lane] = of_copy[kind][d][block.start + lane];
      of_copy[kind][d] = room[kind][d] - block.start;
    }
  move<FRICTION, DAMPED>(copy, block, total, tally);
  double *const *const of_pass[] = {pass.x, pass.v, pass.seen};
  for (int kind = 0; kind < KINDS; ++kind)
    for (int d = 0; d < 3; ++d)
      for (int lane = 0; lane < block.lanes; ++lane) of_pass[kind][d][block.start + lane] = room[kind][d][lane];
}

// --- a whole range ---

template <bool DAMPED> MDANIM_ALWAYS_INLINE void feel_anywhere(const Pass &pass, const Block &block, unsigned &e, double *total)
{
  if (__builtin_expect(block.at_border, 0))
    DAMPED &&block.damped ? feel_at_border<DAMPED, DAMPED>(pass, block, e, total)
                          : feel_at_border<DAMPED, false>(pass, block, e, total);
  else if (DAMPED && block.damped)
    feel<true>(pass, block, e, total);
  else
    feel<false>(pass, block, e, total);
  if (__builtin_expect(is_pushed(block), 0)) take_external_force(pass, block, total);
}

template <Friction FRICTION, bool DAMPED>
MDANIM_ALWAYS_INLINE void move_anywhere(const Pass &pass, const Block &block, const double *total, Tally &tally)
{
  if (__builtin_expect(block.at_border && block.start + LANES > pass.range->end, 0))
    move_at_border<FRICTION, DAMPED>(pass, block, total, tally);
  else
    move<FRICTION, DAMPED>(pass, block, total, tally);
}

// The step of a strip.
template <Friction FRICTION, bool DAMPED_PASS, bool DAMPED>
MDANIM_ALWAYS_INLINE void step_strip(const Pass &pass, const Block *block, unsigned &e, Tally &tally)
{
  constexpr int NUMBERS = FELT<DAMPED> * LANES;
  alignas(64) double felt[LONGEST_STRIP * NUMBERS], total[FELT<DAMPED_PASS> * LANES];
  feel_strip<DAMPED>(pass, block, e, felt);
  const Block *const end = block + block->strip;
  for (const double *own = felt; block < end; ++block, own += NUMBERS) {
    add_up<DAMPED>(pass, *block, Felt::from<DAMPED>(own), total);
    if (__builtin_expect(is_pushed(*block), 0)) take_external_force(pass, *block, total);
    move<FRICTION, DAMPED_PASS>(pass, *block, total, tally);
  }
  e = end[-1].end;
}

// A block alone moves while the next one's springs keep the divider busy, so nothing waits for its forces.
template <Friction FRICTION, bool DAMPED> MDANIM_ALWAYS_INLINE void go(Pass &pass)
{
  double total[2][FELT<DAMPED> * LANES];
  Tally tally;
  tally.box.open();
  const Block *const block = pass.block + pass.range->first;
  const int blocks = pass.range->blocks;
  unsigned e = pass.range->first_entry;
  if (pass.range->below) see_crossed<DAMPED>(pass, *pass.range->below);
  const Block *waiting = nullptr;    // a block that has not moved
  for (int n = 0; n < blocks; n += block[n].strip) {
    const bool alone = block[n].strip == 1;
    if (alone) feel_anywhere<DAMPED>(pass, block[n], e, total[n & 1]);
    if (waiting) move_anywhere<FRICTION, DAMPED>(pass, *waiting, total[~n & 1], tally);
    waiting = alone ? block + n : nullptr;
    if (alone) continue;
    if (DAMPED && block[n].damped)
      step_strip<FRICTION, DAMPED, DAMPED>(pass, block + n, e, tally);
    else
      step_strip<FRICTION, DAMPED, false>(pass, block + n, e, tally);
  }
  if (waiting) move_anywhere<FRICTION, DAMPED>(pass, *waiting, total[~blocks & 1], tally);

  if (pass.trace) tally.turn_to_object(-1, pass);
  tally.turn_to_chunk(-1, pass);
  pass.fastest = pass.squares = pass.largest_phi = 0.0;
  pass.fastest_near = -1.0;
  for (int lane = 0; lane < LANES; ++lane) {
    if (tally.fastest[lane] > pass.fastest) pass.fastest = tally.fastest[lane];
    pass.squares += tally.squares[lane];
    if (tally.fastest_near[lane] > pass.fastest_near) pass.fastest_near = tally.fastest_near[lane];
    if (tally.largest_phi[lane] > pass.largest_phi) pass.largest_phi = tally.largest_phi[lane];
  }
}

template <Friction FRICTION> MDANIM_ALWAYS_INLINE void with_or_without_dashpots(Pass &pass)
{
  if (pass.damped_law)
    go<FRICTION, true>(pass);
  else
    go<FRICTION, false>(pass);
}

void pass_of_range(Pass &pass)
{
  switch (pass.friction) {
    case Friction::NONE:
      with_or_without_dashpots<Friction::NONE>(pass);
      break;
    case Friction::IMPLICIT:
      with_or_without_dashpots<Friction::IMPLICIT>(pass);
      break;
    case Friction::EXPONENTIAL:
      with_or_without_dashpots<Friction::EXPONENTIAL>(pass);
      break;
  }
}

}    // namespace
}    // namespace mdanim
