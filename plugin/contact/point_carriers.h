// SPDX-License-Identifier: GPL-2.0-only
// The particles that carry the points of a body, as kernels read them. Plain data; simd/of_set.h says why.

#pragma once

#include "contact/padded_vec3.h"

namespace mdanim {

// A particle that carries a point: its number by ContactBody::slot_of(), and its weight.
struct PointCarrier {
  int slot;
  double weight;
};

// Carriers of a point, and from `middle` on those of the centre of its area if it has others.
struct PointCarriers {
  const PointCarrier *first, *middle, *last;
};

// Carriers of all points of a body.
struct BodyCarriers {
  const PointCarrier *all;
  const int *first;    // of each point, then of the centre of its area; at the end, the number of all
};

// The outward normal of a point, by the edges of the cell that carries it [m], and the place of that cell's low corner in the
// grid.
struct PointFacing {
  Vec3 by_cells;
  int place;
};

// The points of an object where its particles are.
struct PointsTask {
  BodyCarriers carriers;
  const double *area;         // of each point
  const int *slot;            // numbers of its particles, by those of carriers
  const PaddedVec3 *place;    // as that of Placed
};

}    // namespace mdanim
