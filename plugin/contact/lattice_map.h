// SPDX-License-Identifier: GPL-2.0-only
// The map from lattice coordinates X of a body to places in space, by the particles of its lattice, and that of forces back.
//   x(X) = sum_b N_b(X) x_b    trilinear: the 8 corners of a cell; smooth: quadratic B-splines on up to 27 particles, linear on
//                              two rows within half a cell of a face: without kinks, and the face is met
// Weights sum to 1 and reproduce X, so forces that are spread by them keep momentum and angular momentum.
// Templates over Real (numbers/real.h), compiled for every set of instructions (contact_kernel_of_set.cpp).

#pragma once

#include "numbers/vec3.h"

#include <cstddef>
#include <cstdint>

namespace mdanim {

template <class Real> MDANIM_ALWAYS_INLINE const Real &component(const Vec<Real> &a, int axis)
{ return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

// The grid of a body's cells, and its depth.
struct Lattice {
  int cells[3];
  const std::uint8_t *filled;    // whether a cell is filled, x fastest
  double edge[3], spacing;       // [m]
  int row, layer;                // distance to the next place along y and z
  const double *depth;           // coefficients of quadratic B-splines on nodes -margin to n + margin; null for a cuboid
  int margin;                    // of the depth: beyond it, less half a cell, the depth is not a distance
};

MDANIM_ALWAYS_INLINE bool is_filled(const Lattice &grid, int i, int j, int k)
{
  return i >= 0 && j >= 0 && k >= 0 && i < grid.cells[0] && j < grid.cells[1] && k < grid.cells[2] &&
         grid.filled[i + grid.cells[0] * (j + static_cast<std::size_t>(grid.cells[1]) * k)];
}

// Goes from a cell to the neighbour that X lies in, if there is one: the filled cell across the face that X is farthest beyond,
// by more than `over` cells.
MDANIM_ALWAYS_INLINE bool step_to_neighbour(const Lattice &grid, int (&cell)[3], const Vec3 &X, double over)
{
  int axis = -1, way = 0;
  for (int d = 0; d < 3; ++d) {
    const double at = component(X, d), below = cell[d] - at, above = at - (cell[d] + 1), out = below < above ? above : below;
    const int to = at < cell[d] ? -1 : 1;
    if (out > over && is_filled(grid, cell[0] + (d == 0) * to, cell[1] + (d == 1) * to, cell[2] + (d == 2) * to))
      over = out, axis = d, way = to;
  }
  if (axis < 0) return false;
  cell[axis] += way;
  return true;
}

// Factors of the weights along an axis, for three nodes from the base on. A node that is not used in any lane has zero weight.
template <class Real> struct AxisWeights {
  Real w[3], slope[3];
  Real bend;    // derivatives of the slopes are bend, -2 bend and bend
  bool uses_first, uses_last;
};

template <class Real> using Weights = AxisWeights<Real>[3];

// Weights are written in their final place: copying them, which compilers do byte by byte, takes as long as computing them.

// Weights of the two nodes of a cell.
template <class Real> MDANIM_ALWAYS_INLINE void linear_weights(const Real &x, const Real &cell, AxisWeights<Real> &of)
{
  of.w[0] = 1.0 - (x - cell), of.w[1] = x - cell, of.w[2] = Real{};
  of.slope[0] = constant<Real>(-1.0), of.slope[1] = constant<Real>(1.0), of.slope[2] = Real{};
  of.bend = Real{};
  of.uses_first = true, of.uses_last = false;
}

// The middle one of three nodes whose splines are at x, of an axis with `cells`.
MDANIM_ALWAYS_INLINE int middle_node(double x, int cells)
{
  const int nearest = static_cast<int>(x + 0.5), most = cells - 1;
  const int below = nearest < most ? nearest : most;
  return below > 1 ? below : 1;
}

template <class Real>
MDANIM_ALWAYS_INLINE void smooth_weights(const Real &x, const Real &middle, int cells, AxisWeights<Real> &of)
{
  if (cells == 1) {
    linear_weights(x, Real{}, of);
    return;
  }
  const Real u = x - middle, p = 0.5 - u, q = 0.5 + u, none{}, one = constant<Real>(1.0);
  const auto low = x<0.5, high = x> cells - 0.5;    // near a face
  const Real inside = pick(low, x, x - (cells - 1.0));
  of.w[0] = pick(low, 1.0 - inside, pick(high, none, 0.5 * p * p));
  of.w[1] = pick(low, inside, pick(high, 1.0 - inside, 0.75 - u * u));
  of.w[2] = pick(low, none, pick(high, inside, 0.5 * q * q));
  of.slope[0] = pick(low, -one, pick(high, none, -p));
  of.slope[1] = pick(low, one, pick(high, -one, -2.0 * u));
  of.slope[2] = pick(low, none, pick(high, one, q));
  of.bend = pick(low, none, pick(high, none, one));
  of.uses_first = any(x < cells - 0.5), of.uses_last = any(x >= 0.5);
}

// x(X) and its gradient: columns J = dx/dX, rows K of the inverse.
template <class Real> struct Spot {
  Vec<Real> x, J[3], K[3];
  Real det{};

  // Converts a displacement in space to one of X, and back.
  MDANIM_ALWAYS_INLINE Vec<Real> to_material(const Vec<Real> &way) const
  { return {dot(K[0], way), dot(K[1], way), dot(K[2], way)}; }
  MDANIM_ALWAYS_INLINE Vec<Real> to_space(const Vec<Real> &way) const { return way.x * J[0] + way.y * J[1] + way.z * J[2]; }
  // Converts a gradient by X to one in space.
  MDANIM_ALWAYS_INLINE Vec<Real> gradient(const Vec<Real> &slope) const
  { return slope.x * K[0] + slope.y * K[1] + slope.z * K[2]; }

  MDANIM_ALWAYS_INLINE void invert()
  {
    const Vec<Real> k0 = cross(J[1], J[2]), k1 = cross(J[2], J[0]), k2 = cross(J[0], J[1]);
    det = dot(J[0], k0);
    const Real over = 1.0 / det;
    K[0] = over * k0;
    K[1] = over * k1;
    K[2] = over * k2;
  }
};

// How much a cell is pressed: 1 where it is not, else at least half of the smallest stretch. `steep` is the square of the
// gradient of X where the cell is undeformed [1/m^2].
template <class Real> MDANIM_ALWAYS_INLINE Real pressed(double steep, const Spot<Real> &spot)
{
  const Real square = dot(spot.K[0], spot.K[0]) + dot(spot.K[1], spot.K[1]) + dot(spot.K[2], spot.K[2]);
  return pick(square > steep, root(steep / square), constant<Real>(1.0));
}

template <bool SMOOTH, class Real> MDANIM_ALWAYS_INLINE bool uses(const AxisWeights<Real> &axis, int n)
{ return SMOOTH ? n == 1 || (n == 0 ? axis.uses_first : axis.uses_last) : n < 2; }

// Sums over three nodes begin at +0, so that a node without weight does not change them; sums over two begin with the first.
template <bool SMOOTH, class Real> MDANIM_ALWAYS_INLINE void add(int n, Vec<Real> &sum, const Vec<Real> &term)
{ sum = SMOOTH || n > 0 ? sum + term : term; }

// place(i, j, k) is the place of the particle that is i, j, k nodes from the base.
template <bool SMOOTH, class Real, class Place>
MDANIM_ALWAYS_INLINE void evaluate_nodes(const Weights<Real> &weights, const Place &place, Spot<Real> &spot)
{
  const AxisWeights<Real> &ax = weights[0], &ay = weights[1], &az = weights[2];
  spot.x = spot.J[0] = spot.J[1] = spot.J[2] = Vec<Real>{};
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    if (!uses<SMOOTH>(az, k)) continue;
    Vec<Real> s, sx, sy;
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) {
      if (!uses<SMOOTH>(ay, j)) continue;
      Vec<Real> t, tx;
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i) {
        if (!uses<SMOOTH>(ax, i)) continue;
        const Vec<Real> x = place(i, j, k);
        add<SMOOTH>(i, t, ax.w[i] * x);
        add<SMOOTH>(i, tx, ax.slope[i] * x);
      }
      add<SMOOTH>(j, s, ay.w[j] * t);
      add<SMOOTH>(j, sx, ay.w[j] * tx);
      add<SMOOTH>(j, sy, ay.slope[j] * t);
    }
    add<SMOOTH>(k, spot.x, az.w[k] * s);
    add<SMOOTH>(k, spot.J[0], az.w[k] * sx);
    add<SMOOTH>(k, spot.J[1], az.w[k] * sy);
    add<SMOOTH>(k, spot.J[2], az.slope[k] * s);
  }
  spot.invert();
}

// Change of the gradient by X of along . x(X), of the smooth map, on a displacement of X.
template <class Real, class Place>
MDANIM_ALWAYS_INLINE Vec<Real> change_of_gradient(const Weights<Real> &weights, const Place &place, const Vec<Real> &along,
                                                  const Vec<Real> &way)
{
  constexpr double BEND[3] = {1.0, -2.0, 1.0};
  const AxisWeights<Real> &ax = weights[0], &ay = weights[1], &az = weights[2];
  Real xx{}, xy{}, xz{}, yy{}, yz{}, zz{};
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    if (!uses<true>(az, k)) continue;
    Real s{}, sx{}, sy{}, sxx{}, sxy{}, syy{};
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) {
      if (!uses<true>(ay, j)) continue;
      Real t{}, tx{}, txx{};
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i) {
        if (!uses<true>(ax, i)) continue;
        const Real at = dot(along, place(i, j, k));
        t += ax.w[i] * at, tx += ax.slope[i] * at, txx += BEND[i] * at;
      }
      s += ay.w[j] * t, sx += ay.w[j] * tx, sxx += ay.w[j] * txx;
      sy += ay.slope[j] * t, sxy += ay.slope[j] * tx, syy += BEND[j] * t;
    }
    xx += az.w[k] * sxx, xy += az.w[k] * sxy, yy += az.w[k] * syy;
    xz += az.slope[k] * sx, yz += az.slope[k] * sy, zz += BEND[k] * s;
  }
  xx = ax.bend * xx, yy = ay.bend * yy, zz = az.bend * zz;
  return {xx * way.x + xy * way.y + xz * way.z, xy * way.x + yy * way.y + yz * way.z, xz * way.x + yz * way.y + zz * way.z};
}

// Calls on(i, j, k, force N_b + dN_b/dX . moment) for every particle b.
template <bool SMOOTH, class Real, class On>
MDANIM_ALWAYS_INLINE void spread_to_nodes(const Weights<Real> &weights, const Vec<Real> &force, const Vec<Real> (&moment)[3],
                                          const On &on)
{
  const AxisWeights<Real> &ax = weights[0], &ay = weights[1], &az = weights[2];
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    if (!uses<SMOOTH>(az, k)) continue;
    const Vec<Real> fz = az.w[k] * force + az.slope[k] * moment[2], zx = az.w[k] * moment[0], zy = az.w[k] * moment[1];
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) {
      if (!uses<SMOOTH>(ay, j)) continue;
      const Vec<Real> fy = ay.w[j] * fz + ay.slope[j] * zy, yx = ay.w[j] * zx;
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i)
        if (uses<SMOOTH>(ax, i)) on(i, j, k, ax.w[i] * fy + ax.slope[i] * yx);
    }
  }
}

}    // namespace mdanim
