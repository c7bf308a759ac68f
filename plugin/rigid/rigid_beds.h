// SPDX-License-Identifier: GPL-2.0-only
// Flat surfaces that bear what is glued together: those of planes, and sides of bodies with flat ones.

#pragma once

#include "rigid/bed.h"
#include "rigid/pair.h"

#include <map>
#include <vector>

namespace mdanim {

class RigidBeds {
 public:
  using TouchesAtPlanes = std::vector<std::vector<std::vector<Touch>>>;    // by planes and bodies

  void forget() { pieces_of.clear(); }    // after glue changed
  // Finds what bodies that are glued together bear more than contact gives them, in space, by the numbers of bodies. Heights
  // within `onset` are one.
  PieceMotions spread(const std::vector<Solid> &solids, const std::vector<SolidPair> &pairs,
                      const std::vector<SolidPlane> &planes, const TouchesAtPlanes &at_plane, double onset);

 private:
  std::map<int, std::vector<int>> pieces_of;    // by numbers of wholes, once they were asked for
};

}    // namespace mdanim
