// SPDX-License-Identifier: GPL-2.0-only
// A point of one object's surface that is in contact with another, its host. Plain data; simd/of_set.h says why.

#pragma once

#include "contact/contact_push.h"

#include <cstdint>

namespace mdanim {

struct FieldContact {
  std::int32_t point, side;
  std::int32_t cell[3], spare;
  ContactState<double> state;
  ContactOutcome<double> last;    // of the last step
};

}    // namespace mdanim
