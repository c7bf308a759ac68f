// SPDX-License-Identifier: GPL-2.0-only
// The particles that carry the points of a body, as kernels read them. Plain data; simd/of_set.h says why.

#pragma once

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

}    // namespace mdanim
