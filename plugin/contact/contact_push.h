// SPDX-License-Identifier: GPL-2.0-only
// The work of a contact in a step, once X of its point is known: depth, the part that counts, forces on the point and the host.
// Templates over Real (numbers/real.h), compiled for every set of instructions (contact_kernel_of_set.cpp).

#pragma once

#include "contact/lattice_map.h"
#include "contact/law.h"

namespace mdanim {

constexpr double SAME_PLACE = 1e-3;    // cells that X may be away from its guess without a second evaluation
constexpr double LEFT = 1e-9;          // cells that X may be outside of its own
constexpr double RAMPS_END = 2.05;     // cells from an edge beyond which the whole area of any point counts

// Volume below which a cell counts as turned over.
MDANIM_ALWAYS_INLINE double smallest_volume(double spacing) { return 0.02 * spacing * spacing * spacing; }

// Volume below which a cell is crushed. There X of a point soon jumps to another one, and contacts of points that use smooth maps
// are let go.
MDANIM_ALWAYS_INLINE double crushed_volume(double spacing) { return 0.25 * spacing * spacing * spacing; }

// Depth below one side [m], and its gradient by X.
template <class Real> struct Depth {
  Real value{};
  Vec<Real> slope;
};

// A side of a cuboid: the axis across it, and 1 at the upper end, 0 at the lower one.
template <class Real> struct CuboidSide {
  Real axis, is_high;
};

template <class Real>
MDANIM_ALWAYS_INLINE Depth<Real> depth_below(const CuboidSide<Real> &side, const Lattice &host, const Vec<Real> &X)
{
  Depth<Real> found;
  Real slope[3];
  const auto high = side.is_high > 0.0;
#pragma GCC unroll 3
  for (int d = 0; d < 3; ++d) {
    const Real at = component(X, d), edge = constant<Real>(host.edge[d]);
    const auto across = side.axis == static_cast<double>(d);
    found.value = pick(across, edge * pick(high, host.cells[d] - at, at), found.value);
    slope[d] = pick(across, pick(high, -edge, edge), Real{});
  }
  found.slope = {slope[0], slope[1], slope[2]};
  return found;
}

// Factors of centred quadratic B-splines at x along an axis of the depth, for three nodes around the middle one.
template <class Real> MDANIM_ALWAYS_INLINE void depth_weights(const Real &x, const Real &middle, AxisWeights<Real> &of)
{
  const Real u = smaller(larger(x - middle, constant<Real>(-0.5)), constant<Real>(0.5)), p = 0.5 - u, q = 0.5 + u;
  of.w[0] = 0.5 * p * p, of.w[1] = 0.75 - u * u, of.w[2] = 0.5 * q * q;
  of.slope[0] = -p, of.slope[1] = -2.0 * u, of.slope[2] = q;
}

MDANIM_ALWAYS_INLINE int depth_row(const Lattice &host, int axis) { return host.cells[axis] + 1 + 2 * host.margin; }

// line(j, k): the three coefficients of a line along x, j and k nodes from the first along y and z.
template <class Real, class Line>
MDANIM_ALWAYS_INLINE Depth<Real> depth_by_splines(const Weights<Real> &weights, const Line &line_at)
{
  const AxisWeights<Real> &ax = weights[0], &ay = weights[1], &az = weights[2];
  Depth<Real> found;
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    Real sum{}, sum_x{}, sum_y{};
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) {
      const Vec<Real> c = line_at(j, k);
      const Real line = (ax.w[0] * c.x + ax.w[1] * c.y) + ax.w[2] * c.z;
      sum += ay.w[j] * line;
      sum_x += ay.w[j] * ((ax.slope[0] * c.x + ax.slope[1] * c.y) + ax.slope[2] * c.z);
      sum_y += ay.slope[j] * line;
    }
    found.value += az.w[k] * sum;
    found.slope += Vec<Real>{az.w[k] * sum_x, az.w[k] * sum_y, az.slope[k] * sum};
  }
  return found;
}

// The ramps near sharp edges of a host, for points of one kind: along each axis, in cells.
struct Ramps {
  double from[3], width[3];
};

// t(X) over a side of a cuboid, and its gradient by X: the product of ramps about all edges of that side.
template <class Real>
MDANIM_ALWAYS_INLINE Real part_that_counts(const Ramps &ramps, const Lattice &host, const Vec<Real> &X, const Real &axis,
                                           Vec<Real> &slope)
{
  Real inside = constant<Real>(RAMPS_END), t[3], dt[3];    // cells from the nearest edge
#pragma GCC unroll 3
  for (int d = 0; d < 3; ++d) {
    const Real nearest = smaller(component(X, d), host.cells[d] - component(X, d));
    inside = smaller(inside, pick(axis == static_cast<double>(d), inside, nearest));
  }
  slope = Vec<Real>{};
  if (!any(inside < RAMPS_END)) return constant<Real>(1.0);
#pragma GCC unroll 3
  for (int d = 0; d < 3; ++d) {
    const auto across = axis == static_cast<double>(d);
    const Ramp<Real> low(component(X, d), ramps.from[d], ramps.width[d]),
        high(host.cells[d] - component(X, d), ramps.from[d], ramps.width[d]);
    t[d] = pick(across, constant<Real>(1.0), low.value * high.value);
    dt[d] = pick(across, Real{}, low.slope * high.value - high.slope * low.value);
  }
  slope = {dt[0] * t[1] * t[2], t[0] * dt[1] * t[2], t[0] * t[1] * dt[2]};
  return t[0] * t[1] * t[2];
}

// Values that a contact brings from the step before and that change in it: X of the point, its change from the step before, and X
// of the anchor of friction, in the host's lattice coordinates.
template <class Real> struct ContactState {
  Vec<Real> X, change, anchor;
  ContactMemory<Real> memory;
};

// Values that are needed when a contact ends.
template <class Real> struct ContactOutcome {
  Vec<Real> force;    // on the point [N]
  Vec<Real> moved;    // against the host in the step [m]
  Real energy;        // of the pressure [J]
};

// Results for one point. The host gets -(N_b both + dN_b/dX . moment).
template <class Real> struct ContactPush {
  ContactOutcome<Real> outcome;
  Vec<Real> at_centre, both, moment[3];
  Real heat, damped, work;
};

// Whether the part that counts has a slope.
template <class Real> MDANIM_ALWAYS_INLINE auto is_on_ramp(const Vec<Real> &part_slope)
{ return (part_slope.x != 0.0) | (part_slope.y != 0.0) | (part_slope.z != 0.0); }

// The part that counts is taken at the centre of a sharp point's area, X + K shift. Where X moves, K changes too: this is its
// effect on the part, as a gradient in space by the place of the point. `shift` is in lattice coordinates.
template <class Real, class Place>
MDANIM_ALWAYS_INLINE Vec<Real> part_turn(const Weights<Real> &weights, const Place &place, const Spot<Real> &spot,
                                         const Vec<Real> &part_slope, const Vec<Real> &shift)
{
  const Vec<Real> turn = spot.gradient(change_of_gradient(weights, place, spot.gradient(part_slope), shift));
  const auto counts = is_on_ramp(part_slope);
  return {pick(counts, turn.x, Real{}), pick(counts, turn.y, Real{}), pick(counts, turn.z, Real{})};
}

// The depth that counts where the host is pressed flat, f = phi d: phi, and the terms of its gradient besides phi times that of
// d, by the place of the point and by the columns of dx/dX.
template <class Real> struct FlattenedDepth {
  bool is_flat = false;
  Real part;
  Vec<Real> on_point, on_column[3];
};

template <class Real> MDANIM_ALWAYS_INLINE auto is_flattened(const Vec<Real> &normal)
{ return dot(normal, normal) > Flattened<double>::STEEP * Flattened<double>::STEEP; }

// d n^2 = -2 sum_a v_a n . d(dx/dX_a),  v = n as a displacement of X.
template <class Real, class Place>
MDANIM_ALWAYS_INLINE FlattenedDepth<Real> flattened_depth(const Weights<Real> &weights, const Place &place,
                                                          const Spot<Real> &spot, const Vec<Real> &normal, const Real &depth)
{
  const Flattened<Real> phi(root(dot(normal, normal)));
  const Vec<Real> along = spot.to_material(normal);
  const Real more = depth * (phi.value * phi.slope);
  FlattenedDepth<Real> flat;
  flat.is_flat = true;
  flat.part = phi.value;
  flat.on_point = more * spot.gradient(change_of_gradient(weights, place, normal, along));
#pragma GCC unroll 3
  for (int d = 0; d < 3; ++d) flat.on_column[d] = (more * component(along, d)) * normal;
  return flat;
}

// `off` is X less its guess, about which everything is linear; `shift` goes from X to the centre of the point's area; `turn` is
// part_turn(); `below` has the depth that counts, and the slope of d.
template <class Real>
MDANIM_ALWAYS_INLINE ContactPush<Real> contact_push(const ContactLaw &law, double dt, const Real &area, const Real &part,
                                                    const Vec<Real> &part_slope, const Vec<Real> &turn, const Depth<Real> &below,
                                                    const FlattenedDepth<Real> &flat, const Spot<Real> &spot,
                                                    const Vec<Real> &off, const Vec<Real> &shift, ContactState<Real> &state)
{
  const Vec<Real> normal = spot.gradient(below.slope);    // gradient of d, in space
  ContactForce<Real> force = contact_pressure(law, area, part, below.value, dt, state.memory);
  const Real press = force.press;    // along the gradient of f
  if (flat.is_flat) force.press = flat.part * press;
  ContactPush<Real> push;
  Vec<Real> lean;
  push.work = Real{};
  if (law.friction > 0.0) {
    // To the depth of the point, along the normal in space; the stick spring does no work on this way.
    lean = state.anchor - state.X;
    const Vec<Real> before = state.memory.pull + state.memory.drag;
    const Vec<Real> way = {constant<Real>(dt * law.belt.x), constant<Real>(dt * law.belt.y), constant<Real>(dt * law.belt.z)};
    if (law.runs()) lean += spot.to_material(way);    // the anchor runs along
    lean -= (dot(lean, below.slope) / dot(normal, normal)) * spot.to_material(normal);
    contact_friction(law, area, part, -1.0 * spot.to_space(lean), normal, dt, state.memory, force);
    lean = force.kept * lean;
    state.anchor = state.X + lean;
    if (law.runs()) push.work = 0.5 * dot(before + force.pull + force.drag, way);
  }
  Vec<Real> on_point = -force.press * normal + force.pull + force.drag + force.surface_energy * turn;
  if (flat.is_flat) on_point -= press * flat.on_point;
  push.at_centre = -force.surface_energy * spot.gradient(part_slope);
  push.both = on_point + push.at_centre;
#pragma GCC unroll 3
  for (int d = 0; d < 3; ++d)
    push.moment[d] = component(off, d) * push.both + component(shift, d) * push.at_centre + component(lean, d) * force.pull;
  if (flat.is_flat)
#pragma GCC unroll 3
    for (int d = 0; d < 3; ++d) push.moment[d] += press * flat.on_column[d];
  push.outcome = {on_point, spot.to_space(state.change), part * force.surface_energy};
  push.heat = force.heat;
  push.damped = force.damped;
  return push;
}

}    // namespace mdanim
