// SPDX-License-Identifier: GPL-2.0-only
// Contacts, four at a time, for one set of instructions: CMake compiles this file once for each (engine/kernels_of_set.cpp).

#include "contact/contact_kernel.h"
#include "engine/vectors.h"

#define MDANIM_NAME_OF(set) #set
#define MDANIM_NAME(set) MDANIM_NAME_OF(set)
#define MDANIM_KERNELS_OF(set) contact_kernels_##set
#define MDANIM_KERNELS(set) MDANIM_KERNELS_OF(set)

namespace mdanim {
namespace {

constexpr int LANES = CONTACT_LANES;
static_assert(LANES == 4, "a row is gathered from four");

// What is told of each lane, as one vector: number(lane) for four lanes.
template <class Number> MDANIM_ALWAYS_INLINE Four gather(const Number &number)
{ return Four{number(0), number(1), number(2), number(3)}; }

template <class Place> MDANIM_ALWAYS_INLINE Vec<Four> gather_vec(const Place &place)
{
  const Vec3 &a = place(0), &b = place(1), &c = place(2), &d = place(3);
  return {Four{a.x, b.x, c.x, d.x}, Four{a.y, b.y, c.y, d.y}, Four{a.z, b.z, c.z, d.z}};
}

MDANIM_ALWAYS_INLINE void store(VecLanes &to, const Vec<Four> &value)
{
  store(to.x, value.x);
  store(to.y, value.y);
  store(to.z, value.z);
}

// Nodes of the smooth map, or of a depth, around X along an axis: the middle ones as numbers, and in lanes.
MDANIM_ALWAYS_INLINE Four middle_nodes(const Four &x, int cells, int (&middle)[LANES])
{
  for (int lane = 0; lane < LANES; ++lane) middle[lane] = middle_node(x[lane], cells);
  return gather([&](int lane) { return static_cast<double>(middle[lane]); });
}

MDANIM_ALWAYS_INLINE Depth<Four> depth_by_splines(const Lattice &host, const Vec<Four> &X)
{
  const long row = depth_row(host, 0), layer = row * depth_row(host, 1);
  const double *first[LANES];
  for (const double *&own : first) own = host.depth;
  Weights<Four> weights;
  for (int d = 0; d < 3; ++d) {
    const Four x = component(X, d) + static_cast<double>(DEPTH_MARGIN);
    int middle[LANES];
    weights[d] = depth_weights(x, middle_nodes(x, depth_row(host, d) - 1, middle));
    for (int lane = 0; lane < LANES; ++lane) first[lane] += (middle[lane] - 1) * (d == 0 ? 1 : d == 1 ? row : layer);
  }
  return depth_by_splines(
      weights, [&](int i, int j, int k) { return gather([&](int lane) { return first[lane][i + row * j + layer * k]; }); });
}

template <bool SMOOTH, bool CUBOID>
MDANIM_ALWAYS_INLINE void push_block(const PushTask &task, const FieldContact *first, const PointNow *now, int n,
                                     PushedBlock &pushed)
{
  const Lattice &host = task.host;
  int number[LANES];    // lanes without a contact repeat the last one
  for (int lane = 0; lane < LANES; ++lane) number[lane] = lane < n ? lane : n - 1;
  const auto contact = [&](int lane) -> const FieldContact & { return first[number[lane]]; };

  ContactState<Four> state;
  state.change = gather_vec([&](int lane) -> const Vec3 & { return contact(lane).change; });
  const Vec<Four> X_before = gather_vec([&](int lane) -> const Vec3 & { return contact(lane).X; });
  const Vec<Four> guess = X_before + state.change;

  Weights<Four> weights;
  Four cell[3];
  const int *slots[LANES];    // of the base
  for (int lane = 0; lane < LANES; ++lane) slots[lane] = task.slot;
  for (int d = 0; d < 3; ++d) {
    const int step = d == 0 ? 1 : d == 1 ? host.row : host.layer;
    if (SMOOTH) {
      int middle[LANES];
      cell[d] = middle_nodes(component(guess, d), host.cells[d], middle);
      weights[d] = smooth_weights(component(guess, d), cell[d], host.cells[d]);
      for (int lane = 0; lane < LANES; ++lane) slots[lane] += (middle[lane] - 1) * step;
    } else {
      cell[d] = gather([&](int lane) { return static_cast<double>(contact(lane).cell[d]); });
      weights[d] = linear_weights(component(guess, d), cell[d]);
      for (int lane = 0; lane < LANES; ++lane) slots[lane] += contact(lane).cell[d] * step;
    }
  }

  int missing[LANES] = {};
  Spot<Four> spot;
  evaluate_nodes<SMOOTH>(
      weights,
      [&](int i, int j, int k) {
        const long step = i + host.row * j + host.layer * k;
        return gather_vec([&](int lane) -> const Vec3 & {
          const int slot = slots[lane][step];
          missing[lane] |= slot;
          return task.place[slot < 0 ? 0 : slot];
        });
      },
      spot);
  const Vec<Four> x = gather_vec([&](int lane) -> const Vec3 & { return now[number[lane]].x; });
  const Vec<Four> off = spot.to_material(x - spot.x);
  state.X = guess + off;
  state.change = state.X - X_before;
  const auto found = (spot.det > smallest_volume(host.spacing)) & (dot(off, off) <= SAME_PLACE * SAME_PLACE);
  Four out{};
  if (!SMOOTH)
    for (int d = 0; d < 3; ++d)
      out = larger(out, larger(cell[d] - component(state.X, d), component(state.X, d) - (cell[d] + 1.0)));

  const Vec<Four> shift = spot.to_material(gather_vec([&](int lane) -> const Vec3 & { return now[number[lane]].shift; }));
  Depth<Four> below;
  Vec<Four> part_slope;
  Four part = constant<Four>(1.0);
  if (CUBOID) {
    const Side<Four> side = {gather([&](int lane) { return static_cast<double>(contact(lane).side >> 1); }),
                             gather([&](int lane) { return static_cast<double>(contact(lane).side & 1); })};
    below = depth_below(side, host, state.X);
    part = part_that_counts(task.ramps, host, state.X + shift, side.axis, part_slope);
  } else {
    below = depth_by_splines(host, state.X);
  }
  const auto stays = (below.value > 0.0) & (part > 0.0) & (below.value <= task.longest);

  state.anchor = gather_vec([&](int lane) -> const Vec3 & { return contact(lane).anchor; });
  state.memory.offset = gather([&](int lane) { return contact(lane).memory.offset; });
  state.memory.depth = gather([&](int lane) { return contact(lane).memory.depth; });
  state.memory.pull = gather_vec([&](int lane) -> const Vec3 & { return contact(lane).memory.pull; });
  state.memory.stick = gather([&](int lane) { return contact(lane).memory.stick; });
  state.memory.damping = gather([&](int lane) { return contact(lane).memory.damping; });
  state.memory.drag = gather_vec([&](int lane) -> const Vec3 & { return contact(lane).memory.drag; });
  const Four area = gather([&](int lane) { return now[number[lane]].area; });
  const ContactPush<Four> push = contact_push(task.law, task.dt, area, part, part_slope, below, spot, off, shift, state);

  pushed.nodes = 0;
  spread_to_nodes<SMOOTH>(weights, -1.0 * push.both, {-1.0 * push.moment[0], -1.0 * push.moment[1], -1.0 * push.moment[2]},
                          [&](int i, int j, int k, const Vec<Four> &force) {
                            const long step = i + host.row * j + host.layer * k;
                            for (int lane = 0; lane < LANES; ++lane) pushed.slot[pushed.nodes][lane] = slots[lane][step];
                            store(pushed.on_node[pushed.nodes++], force);
                          });
  pushed.hard = ~bits(found & stays) & ((1 << n) - 1);
  for (int lane = 0; lane < n; ++lane) pushed.hard |= (missing[lane] < 0) << lane;
  pushed.outside = bits(out > LEFT);
  pushed.on_ramp = bits((part_slope.x != 0.0) | (part_slope.y != 0.0) | (part_slope.z != 0.0));
  store(pushed.X, state.X);
  store(pushed.change, state.change);
  store(pushed.anchor, state.anchor);
  store(pushed.pull, state.memory.pull);
  store(pushed.force, push.on_point);
  store(pushed.moved, push.moved);
  store(pushed.at_centre, push.at_centre);
  store(pushed.offset, state.memory.offset);
  store(pushed.depth, state.memory.depth);
  store(pushed.stick, state.memory.stick);
  store(pushed.stick_energy, state.memory.stick_energy);
  store(pushed.damping, state.memory.damping);
  store(pushed.drag, state.memory.drag);
  store(pushed.energy, push.energy);
  store(pushed.heat, push.heat);
  store(pushed.damped, push.damped);
}

void push(const PushTask &task, const FieldContact *first, const PointNow *now, int n, PushedBlock &pushed)
{
  if (task.host.depth)
    push_block<false, false>(task, first, now, n, pushed);
  else if (task.is_smooth)
    push_block<true, true>(task, first, now, n, pushed);
  else
    push_block<false, true>(task, first, now, n, pushed);
}

}    // namespace

extern const ContactKernels MDANIM_KERNELS(MDANIM_SET);
const ContactKernels MDANIM_KERNELS(MDANIM_SET) = {MDANIM_NAME(MDANIM_SET), push};

}    // namespace mdanim
