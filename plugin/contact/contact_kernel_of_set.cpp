// SPDX-License-Identifier: GPL-2.0-only
// Contacts, four at a time, for one set of instructions (simd/of_set.h).

#include "contact/contact_lanes.h"
#include "simd/of_set.h"

namespace mdanim {
namespace {

// Places of the points of contacts in the host: about X = `guess`, from which they are `off`, everything is linear.
struct Followed {
  Vec<Four> guess, off;
  Weights<Four> weights;
  Spot<Four> spot;
  int cell[LANES][3];
  const int *slots[LANES];    // numbers of the host's nodes, from the first on
  int lost;                   // one bit for each lane that is not found
};

// place(i, j, k) for evaluate_nodes() in all lanes.
MDANIM_ALWAYS_INLINE auto places_around(const PushTask &task, const Followed &found)
{
  return [&task, &found](int i, int j, int k) {
    const long step = i + task.host.row * j + task.host.layer * k;
    return gather_rows([&](int lane) { return &task.place[found.slots[lane][step]].value.x; });
  };
}

// Does the work of follow() in contact_follow.h for all lanes at once: a lane that has its place repeats the same numbers.
template <bool SMOOTH> MDANIM_ALWAYS_INLINE void follow(const PushTask &task, const Vec<Four> &x, Followed &found)
{
  constexpr int MOST = 4;
  const Lattice &host = task.host;
  found.lost = 0;
  int again = ALL;
  for (int round = 0; again; ++round) {
    Four cell[3];
#pragma GCC unroll 8
    for (int lane = 0; lane < LANES; ++lane) found.slots[lane] = task.slot;
#pragma GCC unroll 3
    for (int d = 0; d < 3; ++d) {
      const int step = d == 0 ? 1 : d == 1 ? host.row : host.layer;
      if (SMOOTH) {
        int middle[LANES];
        cell[d] = middle_nodes(component(found.guess, d), host.cells[d], middle);
        smooth_weights(component(found.guess, d), cell[d], host.cells[d], found.weights[d]);
#pragma GCC unroll 8
        for (int lane = 0; lane < LANES; ++lane) found.slots[lane] += (middle[lane] - 1) * step;
      } else {
        cell[d] = gather([&](int lane) { return static_cast<double>(found.cell[lane][d]); });
        linear_weights(component(found.guess, d), cell[d], found.weights[d]);
#pragma GCC unroll 8
        for (int lane = 0; lane < LANES; ++lane) found.slots[lane] += found.cell[lane][d] * step;
      }
    }
    long missing[LANES] = {};
    evaluate_nodes<SMOOTH>(
        found.weights,
        [&](int i, int j, int k) {
          const long step = i + host.row * j + host.layer * k;
          return gather_rows([&](int lane) {
            const long slot = found.slots[lane][step];
            missing[lane] |= slot;
            return &task.place[slot].value.x;
          });
        },
        found.spot);
    found.off = found.spot.to_material(x - found.spot.x);
    found.lost |= ALL & ~bits(found.spot.det > smallest_volume(host.spacing));
#pragma GCC unroll 8
    for (int lane = 0; lane < LANES; ++lane) found.lost |= (missing[lane] < 0) << lane;

    const Four square = dot(found.off, found.off);
    const auto is_far = square > SAME_PLACE * SAME_PLACE;
    const int far = bits(is_far);
    again = far;
    if (!SMOOTH) {
      const Vec<Four> X = found.guess + found.off;
      Four out{};
#pragma GCC unroll 3
      for (int d = 0; d < 3; ++d) out = larger(out, larger(cell[d] - component(X, d), component(X, d) - (cell[d] + 1.0)));
      const int outside = bits(out > LEFT) & ~far & ~found.lost;
      int leaves = 0;
      for (int lane = 0; outside >> lane; ++lane)
        if (outside >> lane & 1 && step_to_neighbour(host, found.cell[lane], {X.x[lane], X.y[lane], X.z[lane]}, LEFT))
          leaves |= 1 << lane;
      (host.depth ? found.lost : again) |= leaves;    // in a round host X may jump; go_on() in contact_follow.cpp deals with it
    }
    again &= ~found.lost;
    if (round == MOST) found.lost |= again, again = 0;
    if (!again) break;
    const Four whole = constant<Four>(1.0), short_of = pick(square > 1.0, 1.0 / root(square), whole);
    const auto goes_on = gather([&](int lane) { return static_cast<double>(again >> lane & 1); }) > 0.0;
    const Vec<Four> next = found.guess + short_of * found.off;
    found.guess = {pick(goes_on, next.x, found.guess.x), pick(goes_on, next.y, found.guess.y),
                   pick(goes_on, next.z, found.guess.z)};
  }
}

// The same for a host that does not deform.
MDANIM_ALWAYS_INLINE void follow_frame(const PushTask &task, const Vec<Four> &x, Followed &found)
{
  const auto all = [](const Vec3 &v) { return Vec<Four>{constant<Four>(v.x), constant<Four>(v.y), constant<Four>(v.z)}; };
  const Spot<double> &rigid = *task.rigid;
  found.lost = 0;
#pragma GCC unroll 3
  for (int d = 0; d < 3; ++d) found.spot.J[d] = all(rigid.J[d]), found.spot.K[d] = all(rigid.K[d]);
  found.off = Vec<Four>{};
  found.guess = found.spot.to_material(x - all(rigid.x));
  for (const int *&slots : found.slots) slots = task.slot;
}

enum class Map { LINEAR, SMOOTH, RIGID };

template <Map MAP, bool CUBOID>
MDANIM_ALWAYS_INLINE void push_block(const PushTask &task, FieldContact *first, const PointNow *now, int n, PushedBlock &pushed)
{
  constexpr bool SMOOTH = MAP == Map::SMOOTH;
  const Lattice &host = task.host;
  int number[LANES];    // lanes without a contact repeat the last one
#pragma GCC unroll 8
  for (int lane = 0; lane < LANES; ++lane) number[lane] = lane < n ? lane : n - 1;
  const auto contact = [&](int lane) -> const FieldContact & { return first[number[lane]]; };

  Followed found;
  found.guess = gather_rows([&](int lane) { return &contact(lane).state.X.x; }) +
                gather_rows([&](int lane) { return &contact(lane).state.change.x; });
#pragma GCC unroll 8
  for (int lane = 0; lane < LANES; ++lane)
#pragma GCC unroll 3
    for (int d = 0; d < 3; ++d) found.cell[lane][d] = contact(lane).cell[d];
  const Vec<Four> x = gather_rows([&](int lane) { return &now[number[lane]].x.x; });
  if constexpr (MAP == Map::RIGID)
    follow_frame(task, x, found);
  else
    follow<SMOOTH>(task, x, found);
  PointOf<Four> point;
  gather_record([&](int lane) { return &now[number[lane]]; }, point);
  ContactState<Four> state;
  gather_record([&](int lane) { return &contact(lane).state; }, state);
  const Vec<Four> X = found.guess + found.off;
  state.change = X - state.X;
  state.X = X;

  const Vec<Four> shift = found.spot.to_material(point.shift);
  Depth<Four> below;
  Vec<Four> part_slope;
  Four part = constant<Four>(1.0);
  if (CUBOID) {
    const CuboidSide<Four> side = {gather([&](int lane) { return static_cast<double>(contact(lane).side >> 1); }),
                                   gather([&](int lane) { return static_cast<double>(contact(lane).side & 1); })};
    below = depth_below(side, host, X);
    part = part_that_counts(task.ramps, host, X + shift, side.axis, part_slope);
  } else {
    below = depth_by_splines(host, X);
  }
  below.value += constant<Four>(task.radius);
  Vec<Four> turn;
  if (SMOOTH && any(is_on_ramp(part_slope)))
    turn = part_turn(found.weights, places_around(task, found), found.spot, part_slope, shift);
  FlattenedDepth<Four> flat;
  int crushed = 0;
  if (SMOOTH) {
    crushed = bits(found.spot.det < crushed_volume(host.spacing));
    const Vec<Four> normal = found.spot.gradient(below.slope);
    if (any(is_flattened(normal))) {
      flat = flattened_depth(found.weights, places_around(task, found), found.spot, normal, below.value);
      below.value = flat.part * below.value;
    }
  }
  const auto stays = (below.value > 0.0) & (part > 0.0) & (below.value <= task.longest);

  const ContactPush<Four> push =
      contact_push(task.law, task.dt, point.area, part, part_slope, turn, below, flat, found.spot, found.off, shift, state);
  pushed.nodes = 0;
  const auto put = [&](long step, const Vec<Four> &force) {
    pushed.step[pushed.nodes] = step;
    PaddedVec3(&row)[LANES] = pushed.on_node[pushed.nodes++];
    const Four column[4] = {force.x, force.y, force.z, Four{}};
    store_columns(column, [&](int lane) { return &row[lane].value.x; });
  };
  const Vec<Four> back = -1.0 * push.both, moment[3] = {-1.0 * push.moment[0], -1.0 * push.moment[1], -1.0 * push.moment[2]};
  if constexpr (MAP != Map::RIGID)
    spread_to_nodes<SMOOTH>(found.weights, back, moment,
                            [&](int i, int j, int k, const Vec<Four> &force) { put(i + host.row * j + host.layer * k, force); });
  else if (task.takes_force)
    spread_to_frame(*task.frame, X, back, moment, put);
  pushed.hard = (found.lost | crushed | ~bits(stays)) & ((1 << n) - 1);
  pushed.on_ramp = bits(is_on_ramp(part_slope));
  FieldContact *to[LANES];
#pragma GCC unroll 8
  for (int lane = 0; lane < LANES; ++lane) {
    pushed.slots[lane] = found.slots[lane];
    to[lane] = lane < n && !(pushed.hard >> lane & 1) ? first + lane : &pushed.unused;
#pragma GCC unroll 3
    for (int d = 0; d < 3; ++d) to[lane]->cell[d] = found.cell[lane][d];
  }
  scatter_record(state, [&](int lane) { return &to[lane]->state; });
  scatter_record(push.outcome, [&](int lane) { return &to[lane]->last; });
  const PushedContact<Four> more = {push.at_centre, push.heat, push.damped, push.work};
  scatter_record(more, [&](int lane) { return &pushed.contact[lane]; });
}

void add_to_nodes(const PushedBlock &pushed, int first, int end, PaddedVec3 *on)
{
  for (int lane = first; lane < end; ++lane) {
    const int *slots = pushed.slots[lane];
    for (int node = 0; node < pushed.nodes; ++node) {
      double *to = &on[slots[pushed.step[node]]].value.x;
      store(to, load<Four>(to) + load<Four>(&pushed.on_node[node][lane].value.x));
    }
  }
}

void find_points(const PointsTask &task, const FieldContact *first, int n, PointNow *now)
{
  for (int c = 0; c < n; ++c) {
    const int point = first[c].point, *const from = &task.carriers.first[2 * point];
    const auto sum = [&](int one, int last) { return weighted_sum(task.carriers, task.slot, task.place, one, last); };
    const Four x = sum(from[0], from[1]), shift = from[1] == from[2] ? Four{} : sum(from[1], from[2]) - x;
    now[c] = {{x[0], x[1], x[2]}, {shift[0], shift[1], shift[2]}, task.area[point]};
  }
}

void add_to_points(const PointsTask &task, const FieldContact *contacts, const PushedBlock &pushed, int first, int end,
                   PaddedVec3 *on)
{
  for (int lane = first; lane < end; ++lane) {
    const int *const from = &task.carriers.first[2 * contacts[lane].point];
    push_carriers(task, from[0], from[1], contacts[lane].last.force, on);
    if (pushed.on_ramp >> lane & 1) {
      const bool own = from[1] < from[2];
      push_carriers(task, from[own], from[1 + own], pushed.contact[lane].at_centre, on);
    }
  }
}

void push(const PushTask &task, FieldContact *first, const PointNow *now, int n, PushedBlock &pushed)
{
  if (task.frame)
    task.host.depth ? push_block<Map::RIGID, false>(task, first, now, n, pushed)
                    : push_block<Map::RIGID, true>(task, first, now, n, pushed);
  else if (task.host.depth)
    push_block<Map::LINEAR, false>(task, first, now, n, pushed);
  else if (task.is_smooth)
    push_block<Map::SMOOTH, true>(task, first, now, n, pushed);
  else
    push_block<Map::LINEAR, true>(task, first, now, n, pushed);
}

}    // namespace

void MDANIM_OF_SET(push_at_plane)(const PlaneTask &task, PlaneContact *first, int n,
                                  PlanePush<double> *pushed);    // contact_plane_of_set.cpp
void MDANIM_OF_SET(add_at_plane)(const PointsTask &task, const PlaneContact *first, int n, const PlanePush<double> *pushed,
                                 PaddedVec3 *on);    // contact_plane_of_set.cpp
void MDANIM_OF_SET(look_at_points)(const LookTask &task, const PointBefore *first, int n,
                                   LookedBlock &looked);        // contact_look_of_set.cpp
MovedBy MDANIM_OF_SET(move_particles)(const MoveTask &task);    // contact_move_of_set.cpp
extern const ContactKernels MDANIM_OF_SET(contact_kernels);
const ContactKernels MDANIM_OF_SET(contact_kernels) = {
    MDANIM_OF_SET(move_particles), find_points,  push,         MDANIM_OF_SET(push_at_plane), MDANIM_OF_SET(add_at_plane),
    MDANIM_OF_SET(look_at_points), add_to_nodes, add_to_points};

}    // namespace mdanim
