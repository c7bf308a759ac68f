// SPDX-License-Identifier: GPL-2.0-only
// The map from lattice coordinates X of a body to places in space (lattice_map.h) and back.

#pragma once

#include "contact/contact_body.h"
#include "contact/lattice_map.h"
#include "contact/padded_vec3.h"

#include <array>

namespace mdanim {

// Places of the particles of a body: `slot` gives their numbers by their place in the grid, -1 for one that is not here, whose
// place may be read.
struct Placed {
  const ContactBody &body;
  const int *slot;
  const PaddedVec3 *place;
};

// Weights of the particles around a point, from the place `base` in the grid on.
struct MapWeights {
  Weights<double> axis;
  bool is_smooth;
  int base;
};

inline MapWeights trilinear(const Vec3 &X, const std::array<int, 3> &cell, const ContactBody &body)
{
  MapWeights weights;
  for (int d = 0; d < 3; ++d) linear_weights<double>(component(X, d), cell[d], weights.axis[d]);
  weights.is_smooth = false;
  weights.base = body.place(cell[0], cell[1], cell[2]);
  return weights;
}

inline MapWeights smooth(const Vec3 &X, const ContactBody &body)
{
  MapWeights weights;
  int middle[3];
  for (int d = 0; d < 3; ++d) {
    middle[d] = middle_node(component(X, d), body.count(d));
    smooth_weights<double>(component(X, d), middle[d], body.count(d), weights.axis[d]);
  }
  weights.is_smooth = true;
  weights.base = body.place(middle[0] - 1, middle[1] - 1, middle[2] - 1);
  return weights;
}

// False when a particle with a weight is not here.
inline bool evaluate(const Placed &host, const MapWeights &weights, Spot<double> &spot)
{
  const int row = host.body.row(), layer = host.body.layer(), *const slots = host.slot + weights.base;
  int missing = 0;
  const auto place = [&](int i, int j, int k) {
    const int slot = slots[i + row * j + layer * k];
    missing |= slot;
    return host.place[slot].value;
  };
  weights.is_smooth ? evaluate_nodes<true>(weights.axis, place, spot) : evaluate_nodes<false>(weights.axis, place, spot);
  return missing >= 0;
}

inline bool is_crushed(const Spot<double> &spot, const ContactBody &body) { return spot.det < crushed_volume(body.spacing()); }

// Adds force N_b + dN_b/dX . moment to every particle b.
inline void spread(const Placed &host, const MapWeights &weights, const Vec3 &force, const Vec3 (&moment)[3], PaddedVec3 *on)
{
  const int row = host.body.row(), layer = host.body.layer(), *const slots = host.slot + weights.base;
  const auto add = [&](int i, int j, int k, const Vec3 &part) { on[slots[i + row * j + layer * k]].value += part; };
  weights.is_smooth ? spread_to_nodes<true>(weights.axis, force, moment, add)
                    : spread_to_nodes<false>(weights.axis, force, moment, add);
}

// Finds the material point at a place in space: Newton's method from X in a filled cell, going to neighbours on the way.
class MaterialSearch {
 public:
  explicit MaterialSearch(const Placed &host) : host(host) {}

  // X and cell are the guess and become the answer. False when a cell is turned over or not here.
  bool solve(const Vec3 &x, std::array<int, 3> &cell, Vec3 &X, bool walk = true) const;
  // The same from the cells around, for a point that is lost.
  bool solve_around(const Vec3 &x, std::array<int, 3> &cell, Vec3 &X) const;
  // The same by the smooth map of a cuboid.
  bool solve_smooth(const Vec3 &x, Vec3 &X) const;
  // Goes to the neighbour that X lies in, if there is one; X may be `over` cells outside of its cell.
  bool step_to_neighbour(std::array<int, 3> &cell, const Vec3 &X, double over) const;
  // Whether a cell is too nearly turned over to be trusted.
  bool is_collapsed(const Spot<double> &spot) const;

 private:
  Placed host;
};

}    // namespace mdanim
