// SPDX-License-Identifier: GPL-2.0-only
// A point of one object's surface that is in contact with another, its host. Plain data, for the reason told in
// engine/kernels_of_set.cpp.

#ifndef MDANIM_FIELD_CONTACT_H
#define MDANIM_FIELD_CONTACT_H

#include "laws/contact.h"

#include <cstdint>

namespace mdanim {

// All but forces are in the host's lattice coordinates.
struct FieldContact {
  std::int32_t point, side;
  std::int32_t cell[3], spare;
  Vec3 X, change;    // in the last step, and from the one before
  Vec3 anchor;
  ContactMemory<double> memory;
  Vec3 force;       // on the point in the last step [N]
  Vec3 moved;       // against the host in the last step [m]
  double energy;    // of the pressure, in the last step [J]
};

}    // namespace mdanim

#endif
