// SPDX-License-Identifier: GPL-2.0-only
// A whole of many pieces in a few groups of pieces, each as one rigid body: what conjugate gradients take many loops to carry
// across a whole, these bear at once.

#pragma once

#include "rigid/glue_springs.h"

#include <vector>

namespace mdanim {

class CoarseGlue {
 public:
  // Pieces at these places in the frame of their whole; none below LEAST pieces.
  void make(const std::vector<GlueSpring> &springs, const std::vector<Vec3> &places);
  bool is_on() const { return !centre.empty(); }
  // Adds the motions by which groups bear these loads.
  void add(const PieceMotions &load, PieceMotions &to) const;

 private:
  static constexpr std::size_t LEAST = 200, MOST_GROUPS = 64, OF_GROUP = 25;

  void find_groups(const std::vector<Vec3> &places);
  void factorize();

  std::vector<int> group;       // of pieces
  std::vector<Vec3> arm;        // of pieces, from the middle of their group
  std::vector<Vec3> centre;     // of groups
  std::vector<double> lower;    // L of L D L^T by rows, D on its diagonal
};

}    // namespace mdanim
