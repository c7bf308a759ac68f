// SPDX-License-Identifier: GPL-2.0-only
// Contacts and points in the lanes of vectors, for the kernels (contact_kernel_of_set.cpp, contact_look_of_set.cpp).

#pragma once

#include "contact/contact_kernel.h"
#include "simd/vectors.h"

namespace mdanim {
namespace {

constexpr int LANES = CONTACT_LANES;
static_assert(LANES == 4, "a row is gathered from four");
constexpr int ALL = (1 << LANES) - 1;

// number(lane) of each lane, as one vector.
template <class Number> MDANIM_ALWAYS_INLINE Four gather(const Number &number)
{
  Four all;
#pragma GCC unroll 8
  for (int lane = 0; lane < LANES; ++lane) all[lane] = number(lane);
  return all;
}

// The same for rows, or for three numbers followed by one more.
template <class OfLane> MDANIM_ALWAYS_INLINE Vec<Four> gather_rows(const OfLane &row)
{
  Four column[4];
  load_columns(row, column);
  return {column[0], column[1], column[2]};
}

// Nodes of the smooth map, or of a depth, around X along an axis: the middle ones as numbers, and in lanes.
MDANIM_ALWAYS_INLINE Four middle_nodes(const Four &x, int cells, int (&middle)[LANES])
{
  typedef int Numbers __attribute__((vector_size(LANES * sizeof(int))));
  const Numbers nearest = __builtin_convertvector(x + 0.5, Numbers), most = Numbers{} + (cells - 1), one = Numbers{} + 1;
  const Numbers below = nearest < most ? nearest : most, inside = below > one ? below : one;    // as middle_node() does
  store(middle, inside);
  return __builtin_convertvector(inside, Four);
}

MDANIM_ALWAYS_INLINE Depth<Four> depth_by_splines(const Lattice &host, const Vec<Four> &X)
{
  const long row = depth_row(host, 0), layer = row * depth_row(host, 1);
  const double *first[LANES];
  for (const double *&own : first) own = host.depth;
  Weights<Four> weights;
#pragma GCC unroll 3
  for (int d = 0; d < 3; ++d) {
    const Four x = component(X, d) + static_cast<double>(host.margin);
    int middle[LANES];
    depth_weights(x, middle_nodes(x, depth_row(host, d) - 1, middle), weights[d]);
#pragma GCC unroll 8
    for (int lane = 0; lane < LANES; ++lane) first[lane] += (middle[lane] - 1) * (d == 0 ? 1 : d == 1 ? row : layer);
  }
  return depth_by_splines(weights,
                          [&](int j, int k) { return gather_rows([&](int lane) { return first[lane] + row * j + layer * k; }); });
}

// Numbers of particles by their places in grids, for each lane.
using Slots = const int *[LANES];

MDANIM_ALWAYS_INLINE Four weighted_sum(const BodyCarriers &carriers, const int *slot, const PaddedVec3 *place, int one, int last)
{
  const auto term = [&](int n) {
    const PointCarrier &carrier = carriers.all[n];
    return carrier.weight * load<Four>(&place[slot[carrier.slot]].value.x);
  };
  Four sum = term(one);
  while (++one < last) sum += term(one);
  return sum;
}

MDANIM_ALWAYS_INLINE void push_carriers(const PointsTask &task, int one, int last, const Vec3 &force, PaddedVec3 *on)
{
  const Four row = {force.x, force.y, force.z, 0.0};
  for (; one < last; ++one) {
    const PointCarrier &carrier = task.carriers.all[one];
    double *const to = &on[task.slot[carrier.slot]].value.x;
    store(to, load<Four>(to) + carrier.weight * row);
  }
}

// Records of doubles, one for each lane, as one record of vectors, and back.
template <class Vectors, class OfLane> MDANIM_ALWAYS_INLINE void gather_record(const OfLane &record, Vectors &vectors)
{
  constexpr int N = sizeof(Vectors) / sizeof(Four);
  static_assert(sizeof(*record(0)) == N * sizeof(double), "they have the same members");
  load_columns([&](int lane) { return reinterpret_cast<const double *>(record(lane)); }, reinterpret_cast<Four(&)[N]>(vectors));
}

template <class Vectors, class OfLane> MDANIM_ALWAYS_INLINE void scatter_record(const Vectors &vectors, const OfLane &record)
{
  constexpr int N = sizeof(Vectors) / sizeof(Four);
  static_assert(sizeof(*record(0)) == N * sizeof(double), "they have the same members");
  store_columns(reinterpret_cast<const Four(&)[N]>(vectors), [&](int lane) { return reinterpret_cast<double *>(record(lane)); });
}

struct Places {
  Vec<Four> x, shift;    // of points; to the centres of their areas
};

MDANIM_ALWAYS_INLINE Places places_of(const BodyCarriers &carriers, const Slots &slot, const PaddedVec3 *place,
                                      const int (&point)[LANES])
{
  Four x[LANES], shift[LANES];
#pragma GCC unroll 8
  for (int lane = 0; lane < LANES; ++lane) {
    const int *const from = &carriers.first[2 * point[lane]];
    x[lane] = weighted_sum(carriers, slot[lane], place, from[0], from[1]);
    shift[lane] = from[1] == from[2] ? Four{} : weighted_sum(carriers, slot[lane], place, from[1], from[2]) - x[lane];
  }
  transpose(x[0], x[1], x[2], x[3]);
  transpose(shift[0], shift[1], shift[2], shift[3]);
  return {{x[0], x[1], x[2]}, {shift[0], shift[1], shift[2]}};
}

}    // namespace
}    // namespace mdanim
