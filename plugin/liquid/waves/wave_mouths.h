// SPDX-License-Identifier: GPL-2.0-only
// Mouths of ducts below held roofs, where liquid turns up or down in an arm of vessels that communicate: (W8').

#pragma once

#include "liquid/waves/law.h"
#include "liquid/waves/wave_columns.h"
#include "numbers/vec3.h"

#include <vector>

namespace mdanim {

class WaveMouths {
 public:
  // The columns must outlive this.
  explicit WaveMouths(WaveColumns &columns) : columns(columns), arm_wide(columns.nx * columns.ny, WaveArrays::NOWHERE) {}

  void list();                      // to be called when walls have changed, before solids are set
  void find_links();                // when solids are set
  void load(const WaveLaw &law);    // gives their links the inertia of this sub-update
  // Momentum along x and y by which the walls of mouths hold back what turns: it has none along the links.
  Vec3 turned() const;
  // Whether the liquid of a span goes up and down as one: the mouths of its arm have all of its inertia then.
  bool in_narrow_arm(long i) const { return arm_wide[columns.span[i].column] < columns.arrays.volume[i]; }

 private:
  struct DuctMouth {
    WaveColumns::LinkPlace link;    // at -1 where other solids have changed it
    int arm, duct;                  // columns
    bool arm_is_first;              // of the link
    double roof, next;              // of the duct; where the face opens again above it
    double u = 0.0;                 // velocity of the link before this sub-update
  };

  WaveColumns &columns;
  std::vector<DuctMouth> mouths;
  std::vector<double> arm_wide;    // of each column: columns of its arm for each mouth of that, or NOWHERE
};

}    // namespace mdanim
