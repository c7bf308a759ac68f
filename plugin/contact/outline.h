// SPDX-License-Identifier: GPL-2.0-only
// Where the surface of a round object can be at most: points that are beyond it need no look. The affine map that fits its
// particles best takes the ellipsoid around its body with it, and no place of the surface is farther beside that than particles
// are, by more than its weights.

#pragma once

#include "contact/contact_body.h"
#include "contact/padded_vec3.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace mdanim {

class Outline {
 public:
  void forget() { all.clear(), has_map = false; }
  // The outline of a round body, from those of its particles whose places in the grid these are, and which are at `place`.
  void begin(const ContactBody &body, const std::vector<Vec3> &grid, const PaddedVec3 *place);
  // The particles, now at `place`, have moved by `way` in the mean, and no point by more than `stir` beside it.
  void follow(const Vec3 &way, double stir, const PaddedVec3 *place);
  bool is_known() const { return has_map; }
  // Where it is known, how far a place is outside, or less; 0 or less tells nothing [m].
  double away(const Vec3 &x) const
  {
    const Vec3 from = x - middle, v = Vec3{dot(into[0], from), dot(into[1], from), dot(into[2], from)} - centre;
    // To the plane on the ellipsoid whose normal goes through v.
    const Vec3 across = v.x * into[0] + v.y * into[1] + v.z * into[2];
    const double square = dot(v, v);
    return (square - std::sqrt(square)) / std::sqrt(dot(across, across)) - beside;
  }
  std::size_t bytes() const { return all.capacity() * sizeof(Fitted); }

 private:
  // A particle: its place where the ellipsoid is a ball of radius 1, from the mean of all, and how it counts in the map.
  struct Fitted {
    Vec3 at, weight;
  };
  void fit(const PaddedVec3 *place);

  std::vector<Fitted> all;
  bool has_map = false;
  Vec3 into[3], middle, centre;    // the map to where the ellipsoid is a ball; the mean of particles, and its centre from that
  double beside = 0.0;             // what the surface may be beside the ellipsoid [m]
  double stirred = 0.0, renewed = 0.0;    // since the map was fitted, and until it is fitted again [m]
  double weights = 0.0;                   // of particles in a place of the surface
};

}    // namespace mdanim
