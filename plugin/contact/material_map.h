// SPDX-License-Identifier: GPL-2.0-only
// From lattice coordinates X of a body to places in space and back, by the particles of its lattice.
//   x(X) = sum_b N_b(X) x_b    trilinear: the 8 corners of a cell; smooth: quadratic B-splines on up to 27 particles, linear on
//                              two rows within half a cell of a face: without kinks, and the face is met
// Weights sum to 1 and reproduce X, so forces that are spread by them keep momentum and angular momentum.

#ifndef MDANIM_MATERIAL_MAP_H
#define MDANIM_MATERIAL_MAP_H

#include "contact/contact_body.h"
#include "laws/vec3.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mdanim {

// Where the particles of a body are: `slot` numbers them by their place in the grid, -1 for one that is not there.
struct Placed {
  const ContactBody &body;
  const int *slot;
  const Vec3 *place;
};

// Factors of the weights along an axis, for nodes from `first` on.
struct AxisWeights {
  int first, n;
  double w[3], slope[3];

  static AxisWeights linear(double x, int cell) { return {cell, 2, {1.0 - (x - cell), x - cell, 0.0}, {-1.0, 1.0, 0.0}}; }

  static AxisWeights smooth(double x, int cells)
  {
    if (cells == 1 || !(x >= 0.5)) return linear(x, 0);    // what is no number, too
    if (x >= cells - 0.5) return linear(x, cells - 1);     // at the half itself the next node would be none
    const int middle = static_cast<int>(std::floor(x + 0.5));
    const double u = x - middle, p = 0.5 - u, q = 0.5 + u;
    return {middle - 1, 3, {0.5 * p * p, 0.75 - u * u, 0.5 * q * q}, {-p, -2.0 * u, q}};
  }
};

using Weights = std::array<AxisWeights, 3>;

inline Weights trilinear(const Vec3 &X, const std::array<int, 3> &cell)
{ return {AxisWeights::linear(X.x, cell[0]), AxisWeights::linear(X.y, cell[1]), AxisWeights::linear(X.z, cell[2])}; }

inline Weights smooth(const Vec3 &X, const ContactBody &body)
{
  return {AxisWeights::smooth(X.x, body.count(0)), AxisWeights::smooth(X.y, body.count(1)),
          AxisWeights::smooth(X.z, body.count(2))};
}

// x(X) and its gradient: columns J = dx/dX, rows K of the inverse.
struct Spot {
  Vec3 x;
  std::array<Vec3, 3> J, K;
  double det = 0.0;

  // A change of place in space as one of X, and the other way round.
  Vec3 to_material(const Vec3 &way) const { return {dot(K[0], way), dot(K[1], way), dot(K[2], way)}; }
  Vec3 to_space(const Vec3 &way) const { return way.x * J[0] + way.y * J[1] + way.z * J[2]; }
  // A gradient by X as one in space.
  Vec3 gradient(const Vec3 &slope) const { return slope.x * K[0] + slope.y * K[1] + slope.z * K[2]; }

  void invert()
  {
    const Vec3 k0 = cross(J[1], J[2]), k1 = cross(J[2], J[0]), k2 = cross(J[0], J[1]);
    det = dot(J[0], k0);
    const double over = 1.0 / det;
    K = {over * k0, over * k1, over * k2};
  }
};

// Loops over up to `MOST` nodes of each axis: always two where that is all, which compilers unroll.
template <int MOST> MDANIM_ALWAYS_INLINE bool evaluate_nodes(const Placed &host, const Weights &weights, Spot &spot)
{
  const auto &[ax, ay, az] = weights;
  const int nx = MOST == 2 ? 2 : ax.n, ny = MOST == 2 ? 2 : ay.n, nz = MOST == 2 ? 2 : az.n;
  const int row = host.body.row(), layer = host.body.layer();
  int missing = 0;
  spot.x = spot.J[0] = spot.J[1] = spot.J[2] = Vec3{};
  for (int k = 0; k < nz; ++k) {
    Vec3 s, sx, sy;
    for (int j = 0; j < ny; ++j) {
      Vec3 t, tx;
      const int *slot = host.slot + ax.first + row * (ay.first + j) + layer * (az.first + k);
      for (int i = 0; i < nx; ++i) {
        missing |= slot[i];
        const Vec3 &x = host.place[std::max(slot[i], 0)];
        t += ax.w[i] * x;
        tx += ax.slope[i] * x;
      }
      s += ay.w[j] * t;
      sx += ay.w[j] * tx;
      sy += ay.slope[j] * t;
    }
    spot.x += az.w[k] * s;
    spot.J[0] += az.w[k] * sx;
    spot.J[1] += az.w[k] * sy;
    spot.J[2] += az.slope[k] * s;
  }
  if (missing < 0) return false;
  spot.invert();
  return true;
}

// False when a particle with a weight is not there.
inline bool evaluate(const Placed &host, const Weights &weights, Spot &spot)
{
  const bool two = weights[0].n == 2 && weights[1].n == 2 && weights[2].n == 2;
  return two ? evaluate_nodes<2>(host, weights, spot) : evaluate_nodes<3>(host, weights, spot);
}

template <int MOST>
MDANIM_ALWAYS_INLINE void spread_to_nodes(const Placed &host, const Weights &weights, const Vec3 &force,
                                          const std::array<Vec3, 3> &moment, Vec3 *on)
{
  const auto &[ax, ay, az] = weights;
  const int nx = MOST == 2 ? 2 : ax.n, ny = MOST == 2 ? 2 : ay.n, nz = MOST == 2 ? 2 : az.n;
  const int row = host.body.row(), layer = host.body.layer();
  for (int k = 0; k < nz; ++k) {
    const Vec3 fz = az.w[k] * force + az.slope[k] * moment[2], zx = az.w[k] * moment[0], zy = az.w[k] * moment[1];
    for (int j = 0; j < ny; ++j) {
      const Vec3 fy = ay.w[j] * fz + ay.slope[j] * zy, yx = ay.w[j] * zx;
      const int *slot = host.slot + ax.first + row * (ay.first + j) + layer * (az.first + k);
      for (int i = 0; i < nx; ++i) on[slot[i]] += ax.w[i] * fy + ax.slope[i] * yx;
    }
  }
}

// Adds force N_b + dN_b/dX . moment to every particle b.
inline void spread(const Placed &host, const Weights &weights, const Vec3 &force, const std::array<Vec3, 3> &moment, Vec3 *on)
{
  const bool two = weights[0].n == 2 && weights[1].n == 2 && weights[2].n == 2;
  two ? spread_to_nodes<2>(host, weights, force, moment, on) : spread_to_nodes<3>(host, weights, force, moment, on);
}

// The material point that is at a place in space: Newton's method from X in a filled cell, going to the neighbours on the way.
class MaterialSearch {
 public:
  explicit MaterialSearch(const Placed &host) : host(host) {}

  // X and cell are the guess and become the answer. False when a cell is turned over or is not there.
  bool solve(const Vec3 &x, std::array<int, 3> &cell, Vec3 &X, bool walk = true) const;
  // The same from the cells around, for what is lost.
  bool solve_around(const Vec3 &x, std::array<int, 3> &cell, Vec3 &X) const;
  // The same by the smooth map, of a cuboid.
  bool solve_smooth(const Vec3 &x, Vec3 &X) const;
  // To the neighbour that X lies in, if there is one; by how much X may stand out is told in cells.
  bool step_to_neighbour(std::array<int, 3> &cell, const Vec3 &X, double over) const;
  // Whether a cell is too far turned over to be believed.
  bool is_collapsed(const Spot &spot) const;

 private:
  static constexpr double SMALLEST = 0.02;    // volume of a cell over that at rest
  Placed host;
};

}    // namespace mdanim

#endif
