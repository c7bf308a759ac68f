// SPDX-License-Identifier: GPL-2.0-only
// Pairs of bodies whose spheres are near each other, or that are in contact.

#pragma once

#include "rigid/pair.h"

#include <cstddef>
#include <set>
#include <utility>
#include <vector>

namespace mdanim {

class NearSolids {
 public:
  using Pairs = std::set<std::pair<int, int>>;
  // Makes the list of pairs anew when bodies have moved far enough, and tells whether it did; contacts stay with their pairs.
  // `excluded`: ids of pairs that are none, the lower one first.
  bool update(const std::vector<Solid> &solids, const Pairs &excluded);
  void forget() { listed_at.clear(); }
  std::size_t bytes() const;

  std::vector<SolidPair> pairs;    // ascending

 private:
  void list(const std::vector<Solid> &solids, const Pairs &excluded);
  void find_ways(const std::vector<Solid> &solids);

  std::vector<Vec3> listed_at;    // centres
  std::vector<double> ways;       // that bodies may go from there before a list is too old
};

}    // namespace mdanim
