// SPDX-License-Identifier: GPL-2.0-only
// Pressure on the sides of the basin and of held bodies in it: phi - z. It is an output and changes nothing.

#pragma once

#include "liquid/waves/wave_columns.h"
#include "numbers/vec3.h"

#include <vector>

namespace mdanim {

class WaveWalls {
 public:
  // The columns must outlive this.
  explicit WaveWalls(const WaveColumns &columns) : columns(columns) { list_faces(); }

  void list_faces();    // to be called when walls have changed
  Vec3 force() const;

 private:
  // The solid part of the face between two columns, or of the basin's side where `other` is -1, from one layer to another.
  struct WallFace {
    int column, other, low, high;
    double x, y;    // its direction from the column, times the part that is solid
  };
  double pressure_on(int column, int low, int high) const;

  const WaveColumns &columns;
  std::vector<WallFace> faces;
};

}    // namespace mdanim
