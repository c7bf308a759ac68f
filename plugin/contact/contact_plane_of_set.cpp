// SPDX-License-Identifier: GPL-2.0-only
// Contacts with a plane, four at a time, for one set of instructions (simd/of_set.h).

#include "contact/contact_lanes.h"
#include "simd/of_set.h"

namespace mdanim {
namespace {

// Without friction a contact keeps its depths alone.
template <bool ROUGH>
MDANIM_ALWAYS_INLINE void push_four(const PlaneTask &task, PlaneContact *first, int n, PlanePush<double> *pushed)
{
  int point[LANES];
  PlaneContact unused_contact;
  PlanePush<double> unused;
  PlaneState<double> *of[LANES], *to[LANES];    // lanes without a contact repeat the last one
  PlanePush<double> *result[LANES];
#pragma GCC unroll 8
  for (int lane = 0; lane < LANES; ++lane) {
    PlaneContact *const contact = first + (lane < n ? lane : n - 1);
    point[lane] = contact->point, of[lane] = &contact->state;
    result[lane] = lane < n ? pushed + lane : &unused;
  }
  const Vec<Four> shift = {constant<Four>(task.shift.x), constant<Four>(task.shift.y), constant<Four>(task.shift.z)};
  Slots slot;
#pragma GCC unroll 8
  for (int lane = 0; lane < LANES; ++lane) slot[lane] = task.points.slot;
  const Vec<Four> x = places_of(task.points.carriers, slot, task.points.place, point).x - shift;    // anchors go with the plane
  PlaneState<Four> state;
  if constexpr (ROUGH) {
    gather_record([&](int lane) { return of[lane]; }, state);
  } else {
    state.memory.offset = gather([&](int lane) { return of[lane]->memory.offset; });
    state.memory.depth = gather([&](int lane) { return of[lane]->memory.depth; });
    state.memory.damping = gather([&](int lane) { return of[lane]->memory.damping; });
  }
  const Four along = task.axis == 0 ? x.x : task.axis == 1 ? x.y : x.z;
  const Four depth = task.sign * (task.at - along) + task.radius, none{};
  const auto down = [&](int axis) { return constant<Four>(axis == task.axis ? -task.sign : -0.0); };
  const PlanePush<Four> push = push_at_plane(task.law, task.dt, gather([&](int lane) { return task.points.area[point[lane]]; }),
                                             {down(0), down(1), down(2)}, x, depth, state);
  const int over = bits(depth <= none);
#pragma GCC unroll 8
  for (int lane = 0; lane < LANES; ++lane) to[lane] = lane < n && !(over >> lane & 1) ? of[lane] : &unused_contact.state;
  scatter_record(push, [&](int lane) { return result[lane]; });
  if constexpr (ROUGH) {
    scatter_record(state, [&](int lane) { return to[lane]; });
  } else {
#pragma GCC unroll 8
    for (int lane = 0; lane < LANES; ++lane) {
      ContactMemory<double> &memory = to[lane]->memory;
      memory.offset = state.memory.offset[lane], memory.depth = state.memory.depth[lane];
      memory.damping = state.memory.damping[lane];
    }
  }
}

}    // namespace

void MDANIM_OF_SET(push_at_plane)(const PlaneTask &task, PlaneContact *first, int n, PlanePush<double> *pushed);
void MDANIM_OF_SET(push_at_plane)(const PlaneTask &task, PlaneContact *first, int n, PlanePush<double> *pushed)
{
  for (int c = 0; c < n; c += LANES) {
    const int lanes = n - c < LANES ? n - c : LANES;
    task.law.friction > 0.0 ? push_four<true>(task, first + c, lanes, pushed + c)
                            : push_four<false>(task, first + c, lanes, pushed + c);
  }
}

void MDANIM_OF_SET(add_at_plane)(const PointsTask &task, const PlaneContact *first, int n, const PlanePush<double> *pushed,
                                 PaddedVec3 *on);
void MDANIM_OF_SET(add_at_plane)(const PointsTask &task, const PlaneContact *first, int n, const PlanePush<double> *pushed,
                                 PaddedVec3 *on)
{
  for (int c = 0; c < n; ++c) {
    if (pushed[c].depth <= 0.0) continue;    // it is over
    const int *const from = &task.carriers.first[2 * first[c].point];
    push_carriers(task, from[0], from[1], pushed[c].force, on);
  }
}

}    // namespace mdanim
