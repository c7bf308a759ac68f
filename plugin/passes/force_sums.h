// SPDX-License-Identifier: GPL-2.0-only
// Forces that a participant of passes gives (pass_participant.h).

#pragma once

#include "contact/padded_vec3.h"

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace mdanim {

// Sums of the forces on the particles of one participant, zero at first.
class ForceSums {
 public:
  // Components of the sum for particle n lie at slot[n], slot[n] + apart and slot[n] + 2 apart.
  ForceSums(double *sums, const long *slot, long apart) : sums(sums), slot(slot), apart(apart) {}
  void add(std::size_t n, const Vec3 &force) const
  {
    double *const to = sums + slot[n];
    to[0] += force.x;
    to[apart] += force.y;
    to[2 * apart] += force.z;
  }
  // Adds the forces on particles from `first` to `end` - 1, two at a time where they lie side by side, and clears them.
  void take(std::size_t first, std::size_t end, PaddedVec3 *force) const
  {
    for (std::size_t n = first; n < end; ++n) {
      PaddedVec3 &one = force[n];
      if (n + 1 < end && slot[n + 1] == slot[n] + 1) {
        PaddedVec3 &next = force[++n];
        if (((digits(one.value) | digits(next.value)) << 1) == 0) continue;    // but for their signs
        double *const to = sums + slot[n - 1];
        add_two(to, one.value.x, next.value.x);
        add_two(to + apart, one.value.y, next.value.y);
        add_two(to + 2 * apart, one.value.z, next.value.z);
        next = {};
      } else {
        add(n, one.value);
      }
      one = {};
    }
  }
  void clear(std::size_t n) const { sums[slot[n]] = sums[slot[n] + apart] = sums[slot[n] + 2 * apart] = 0.0; }

 private:
  static std::uint64_t digits(const Vec3 &force)
  {
    std::uint64_t own[3];
    std::memcpy(own, &force, sizeof own);
    return own[0] | own[1] | own[2];
  }
  static void add_two(double *to, double first, double second)
  {
    typedef double Two __attribute__((vector_size(16), aligned(8), may_alias));
    *reinterpret_cast<Two *>(to) += Two{first, second};
  }

  double *sums;
  const long *slot;
  long apart;
};

}    // namespace mdanim
