// SPDX-License-Identifier: GPL-2.0-only
// Pairs of bodies whose spheres are near each other, or that are in contact.

#pragma once

#include "rigid/pair.h"

#include <vector>

namespace mdanim {

class NearSolids {
 public:
  // Makes the list of pairs anew when bodies have moved far enough; contacts stay with their pairs.
  void update(const std::vector<Solid> &solids);
  void forget() { listed_at.clear(); }

  std::vector<SolidPair> pairs;    // ascending

 private:
  void list(const std::vector<Solid> &solids);

  double skin = 0.0;
  std::vector<Vec3> listed_at;    // centres
};

}    // namespace mdanim
