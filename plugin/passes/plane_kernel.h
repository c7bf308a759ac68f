// SPDX-License-Identifier: GPL-2.0-only
// Contacts of particles with planes in a pass, by the law of the plain style (contact/plane_contact.h). What PlaneField does
// where a contact begins and ends is done here in lanes.

#pragma once

#include "contact/plane_contact.h"
#include "passes/spring_kernel.h"

namespace mdanim {
namespace {

MDANIM_ALWAYS_INLINE bool any_lane(const decltype(Vector{} > 0.0) &yes)
{
#ifdef __AVX512DQ__
  typedef long long Lanes __attribute__((vector_size(64)));
  return __builtin_ia32_cvtq2mask512(reinterpret_cast<Lanes>(yes));
#elif defined(__AVX2__)
  return bits(yes);
#else
  return any(yes);
#endif
}

MDANIM_ALWAYS_INLINE Vector3 pick_each(const decltype(Vector{} > 0.0) &yes, const Vector3 &a, const Vector3 &b)
{ return {pick(yes, a.x, b.x), pick(yes, a.y, b.y), pick(yes, a.z, b.z)}; }

// The force of a row of planes on the particles of a block, which are at x. Without friction it is along the axis, and returned
// as if that were x.
template <bool ROUGH> MDANIM_ALWAYS_INLINE Vector3 force_of_planes(const PlaneRows &rows, const PlaneRow &row, const Vector3 &x)
{
  const Vector none{};
  const double *const own = rows.coefficient + static_cast<unsigned long>(row.coefficients) * (PLANE_COEFFICIENTS * LANES);
  double *const kept = rows.kept + static_cast<long>(row.kept) * LANES;
  const auto known = [kept](int number) { return load(kept + number * LANES); };
  const auto keep = [kept](int number, const Vector &value) { store(kept + number * LANES, value); };
  const PlaneLaw &at_plane = rows.law[row.law];
  ContactLaw law = at_plane.law;
  if constexpr (!ROUGH) law.friction = law.damping = 0.0;

  const Vector sign = load(own + SIGN * LANES), along = row.axis == 0 ? x.x : row.axis == 1 ? x.y : x.z;
  const Vector depth = sign * (load(own + AT * LANES) - along) + at_plane.radius, before = known(DEPTH);
  const auto touches = depth > none, touched = before > none;
  PlaneState<Vector> state{};
  ContactMemory<Vector> &memory = state.memory;
  memory.offset = known(OFFSET);
  memory.depth = pick(touched, before, depth);
  Vector3 downward;
  if constexpr (ROUGH) {
    state.anchor = pick_each(touched, load_own(kept + ANCHOR * LANES), x);
    memory.damping = known(DAMPING), memory.stick = known(STICK), memory.stick_energy = known(STICK_ENERGY);
    memory.pull = load_own(kept + PULL * LANES), memory.drag = load_own(kept + DRAG * LANES);
    const Vector flat = constant<Vector>(-0.0);
    downward = {row.axis == 0 ? -sign : flat, row.axis == 1 ? -sign : flat, row.axis == 2 ? -sign : flat};
  } else {
    downward.x = -sign;    // whatever the axis
    if (__builtin_expect(any_lane(touches & (before <= none)), 0))
      store_own(kept + ANCHOR * LANES, pick_each(touched, load_own(kept + ANCHOR * LANES), x));
  }
  const ContactMemory<Vector> last = memory;
  const PlanePush<Vector> push = push_at_plane(law, rows.dt, load(own + AREA * LANES), downward, x, depth, state);

  keep(OFFSET, pick(touches, memory.offset, none));
  keep(DEPTH, pick(touches, depth, none));
  keep(DEEPEST, larger(known(DEEPEST), depth));
  if constexpr (ROUGH) {
    store_own(kept + ANCHOR * LANES, state.anchor);
    keep(DAMPING, pick(touches, memory.damping, none));
    keep(STICK, pick(touches, memory.stick, none));
    keep(STICK_ENERGY, pick(touches, memory.stick_energy, none));
    const Vector3 zero{};
    store_own(kept + PULL * LANES, pick_each(touches, memory.pull, zero));
    store_own(kept + DRAG * LANES, pick_each(touches, memory.drag, zero));
    // A contact that has ended leaves what its springs held, and its last forces do work in half of the step; those of a lane
    // without a contact are 0.
    const Vector ended = 0.5 * last.damping * (depth - last.depth);
    keep(HEAT, known(HEAT) + pick(touches, push.heat, last.stick_energy));
    keep(DAMPED, known(DAMPED) + pick(touches, push.damped, ended));
    return pick_each(touches, push.force, zero);
  }
  return push.force;    // 0 where nothing touches
}

// The next row of the same provider; null for none.
MDANIM_ALWAYS_INLINE const PlaneRow *after(const PlaneRow *row)
{ return row->is_last || row[1].provider != row->provider ? nullptr : row + 1; }

__attribute__((noinline)) void push_with_friction(const PlaneRows &rows, const PlaneRow *row, const Vector3 &x, double *total)
{
  Vector3 sum{};
  for (; row; row = after(row)) sum += force_of_planes<true>(rows, *row, x);
  store_own(total, load_own(total) + sum);
}

// Rows across one axis follow each other.
MDANIM_ALWAYS_INLINE void push_without_friction(const PlaneRows &rows, const PlaneRow *row, const Vector3 &x, double *total)
{
  while (row) {
    double *const along = total + row->axis * LANES;
    Vector sum = force_of_planes<false>(rows, *row, x).x;
    const PlaneRow *next = after(row);
    for (; next && next->axis == row->axis; next = after(next)) sum += force_of_planes<false>(rows, *next, x).x;
    store(along, load(along) + sum);
    row = next;
  }
}

}    // namespace
}    // namespace mdanim
