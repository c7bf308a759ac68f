// SPDX-License-Identifier: GPL-2.0-only
// Points without a contact, four at a time, for one set of instructions (simd/of_set.h). Lanes in which a contact may begin, or
// whose place takes a search, are left to others.

#include "contact/contact_lanes.h"
#include "simd/of_set.h"

namespace mdanim {
namespace {

constexpr double CLOSE = 3.0;    // cells from the middle of the cell of a point
constexpr int MOST_GUESSES = 3;

// The sum over the nodes whose numbers begin at slots[lane]. `missing` gets a bit for each lane whose nodes are not all here.
template <bool SMOOTH>
MDANIM_ALWAYS_INLINE void evaluate_from(const Weights<Four> &weights, const Slots &slots, long row, long layer,
                                        const PaddedVec3 *place, Spot<Four> &spot, int &missing)
{
  long least[LANES] = {};
  evaluate_nodes<SMOOTH>(
      weights,
      [&](int i, int j, int k) {
        const long step = i + row * j + layer * k;
        return gather_rows([&](int lane) {
          const long slot = slots[lane][step];
          least[lane] |= slot;
          return &place[slot].value.x;
        });
      },
      spot);
#pragma GCC unroll 8
  for (int lane = 0; lane < LANES; ++lane) missing |= (least[lane] < 0) << lane;
}

// The outward normals of points, in space, and the edges of the cells that turn them.
MDANIM_ALWAYS_INLINE Vec<Four> normals_of(const LookTask &task, const PointBefore *const (&of)[LANES], Four &edge, int &missing)
{
  Spot<Four> spot;
  edge = constant<Four>(task.spacing);
  if (task.is_rigid) {
#pragma GCC unroll 3
    for (int d = 0; d < 3; ++d) spot.K[d] = gather_rows([&](int lane) { return &of[lane]->rigid->K[d].x; });
  } else {
    Weights<Four> middle;
    for (AxisWeights<Four> &axis : middle) linear_weights(constant<Four>(0.5), Four{}, axis);
    Slots slots;
#pragma GCC unroll 8
    for (int lane = 0; lane < LANES; ++lane) slots[lane] = of[lane]->own_slot + task.facing[of[lane]->point].place;
    evaluate_from<false>(middle, slots, task.row, task.layer, task.place, spot, missing);
    edge = edge * pressed(task.own_steep, spot);
  }
  const Vec<Four> along = spot.gradient(gather_rows([&](int lane) { return &task.facing[of[lane]->point].by_cells.x; }));
  const Four length = root(dot(along, along));
  missing |= ALL & ~bits(length > 0.0);
  return (1.0 / length) * along;
}

// X of points in the host by steps of Newton's method. A lane that has its place repeats the same numbers, so that no lane
// depends on the others.
struct Guessed {
  Vec<Four> X;
  Four off;    // from the last guess
  Spot<Four> spot;
  int cell[LANES][3];
  int unsure = 0;    // one bit for each lane whose place takes a search
};

template <bool SMOOTH>
MDANIM_ALWAYS_INLINE void guess(const LookTask &task, const Slots &of_host, const Vec<Four> &x, Guessed &found)
{
  const Lattice &host = task.host;
  const double least = WHOLE_CELL * host.spacing * host.spacing * host.spacing;
  Vec<Four> from = found.X;
  int again = ALL;
  for (int step = 0; again && step < MOST_GUESSES; ++step) {
    Weights<Four> weights;
    Four cell[3];
    Slots slots;
#pragma GCC unroll 8
    for (int lane = 0; lane < LANES; ++lane) slots[lane] = of_host[lane];
#pragma GCC unroll 3
    for (int d = 0; d < 3; ++d) {
      const int along = d == 0 ? 1 : d == 1 ? host.row : host.layer;
      cell[d] = gather([&](int lane) { return static_cast<double>(found.cell[lane][d]); });
      if (SMOOTH) {
        int middle[LANES];
        const Four node = middle_nodes(component(from, d), host.cells[d], middle);
        smooth_weights(component(from, d), node, host.cells[d], weights[d]);
#pragma GCC unroll 8
        for (int lane = 0; lane < LANES; ++lane) slots[lane] += (middle[lane] - 1) * along;
      } else {
        linear_weights(component(from, d), cell[d], weights[d]);
#pragma GCC unroll 8
        for (int lane = 0; lane < LANES; ++lane) slots[lane] += found.cell[lane][d] * along;
      }
    }
    int missing = 0;
    evaluate_from<SMOOTH>(weights, slots, host.row, host.layer, task.place, found.spot, missing);
    const Vec<Four> change = found.spot.to_material(x - found.spot.x);
    const Four square = dot(change, change);
    found.X = from + change;
    found.off = root(square);
    found.unsure |= missing | (ALL & ~bits((found.spot.det > least) & (square < 1.0)));
    again = ALL & ~bits(square < NEAR_PLACE * NEAR_PLACE);
    Four out{};
#pragma GCC unroll 3
    for (int d = 0; d < 3; ++d) {
      const Four from_middle = component(found.X, d) - (cell[d] + 0.5);
      out = larger(out, larger(from_middle, -from_middle));
    }
    const int outside = bits(out > 0.5 + LEFT);
    for (int lane = 0; outside >> lane; ++lane)
      if (outside >> lane & 1 && !(found.unsure >> lane & 1) &&
          step_to_neighbour(host, found.cell[lane], {found.X.x[lane], found.X.y[lane], found.X.z[lane]}, LEFT))
        again |= 1 << lane;
    again &= ~found.unsure;
    const auto goes_on = gather([&](int lane) { return static_cast<double>(again >> lane & 1); }) > 0.0;
    from = {pick(goes_on, found.X.x, from.x), pick(goes_on, found.X.y, from.y), pick(goes_on, found.X.z, from.z)};
  }
  found.unsure |= again;
  Four away{};
#pragma GCC unroll 3
  for (int d = 0; d < 3; ++d) {
    const Four from_middle = component(found.X, d) - gather([&](int lane) { return found.cell[lane][d] + 0.5; });
    away += from_middle * from_middle;
  }
  found.unsure |= ALL & ~bits(away < CLOSE * CLOSE);
}

template <bool SMOOTH, bool CUBOID>
MDANIM_ALWAYS_INLINE void look_at(const LookTask &task, const PointBefore *first, int n, LookedBlock &looked)
{
  const Lattice &host = task.host;
  const PointBefore *of[LANES];    // lanes without a point repeat the last one
  int point[LANES];
  Slots of_host, own;
#pragma GCC unroll 8
  for (int lane = 0; lane < LANES; ++lane) {
    of[lane] = first + (lane < n ? lane : n - 1);
    point[lane] = of[lane]->point, of_host[lane] = of[lane]->slot, own[lane] = of[lane]->own_slot;
  }
  const Places at = places_of(task.carriers, own, task.place, point);
  Guessed found;
  found.X = gather_rows([&](int lane) { return &of[lane]->X.value.x; });
#pragma GCC unroll 8
  for (int lane = 0; lane < LANES; ++lane)
#pragma GCC unroll 3
    for (int d = 0; d < 3; ++d) found.cell[lane][d] = of[lane]->cell[d];
  guess<SMOOTH>(task, of_host, at.x, found);
  const Spot<Four> &spot = found.spot;
  const Vec<Four> &X = found.X;

  Four turning{};
  Vec<Four> normal;
  if (task.facing) normal = normals_of(task, of, turning, found.unsure);
  turning = smaller(turning, constant<Four>(host.spacing));
  const Vec<Four> X_centre = X + spot.to_material(at.shift);
  const Four press = PRESSED * pressed(task.steep, spot), everywhere = constant<Four>(-1e30);
  const Judge<Four> judge = {host, task.ramps, task.radius, X_centre, spot, normal, turning, press, found.off, !task.facing};
  const Judged<Four> judged = judge_sides<CUBOID>(
      judge,
      [&](int side) {
        if constexpr (CUBOID)
          return depth_below(CuboidSide<Four>{constant<Four>(side / 2), constant<Four>(side & 1)}, host, X);
        else
          return depth_by_splines(host, X);
      },
      [&](int) { return everywhere; });
  looked.sure = ((1 << n) - 1) & ~found.unsure & ~bits(judged.is_unsure > 0.0);
  store(looked.slack, judged.slack);
  const auto put = [](const Vec<Four> &from, PaddedVec3(&to)[LANES]) {
    const Four column[4] = {from.x, from.y, from.z, Four{}};
    store_columns(column, [&](int lane) { return &to[lane].value.x; });
  };
  put(at.x, looked.x);
  put(X, looked.X);
#pragma GCC unroll 8
  for (int lane = 0; lane < LANES; ++lane)
#pragma GCC unroll 3
    for (int d = 0; d < 3; ++d) looked.cell[lane][d] = found.cell[lane][d];
}

}    // namespace

void MDANIM_OF_SET(look_at_points)(const LookTask &task, const PointBefore *first, int n, LookedBlock &looked);
void MDANIM_OF_SET(look_at_points)(const LookTask &task, const PointBefore *first, int n, LookedBlock &looked)
{
  if (task.host.depth)
    look_at<false, false>(task, first, n, looked);
  else if (task.is_smooth)
    look_at<true, true>(task, first, n, looked);
  else
    look_at<false, true>(task, first, n, looked);
}

}    // namespace mdanim
