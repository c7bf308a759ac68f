// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions over Occupancy, for tests.

#include "c_api/abi.h"
#include "liquid/occupancy.h"

#include <algorithm>

using mdanim::Occupancy;
using mdanim::Vec3;

// Counts of n lattice cells with eight corners each (VTK order, in cells), samples at points or spread; those with `layers` of
// others around them may fill what is inside. nullptr where none is known. `box`: low and high of what has been touched, nullptr
// where it is not wanted.
MDANIM_EXPORT void mdanim_occupancy_of_cells(int nx, int ny, int nz, int n, const double *corners, const int *layers, int spread,
                                             int *count, int *box)
{
  Occupancy occupancy(nx, ny, nz);
  for (int cell = 0; cell < n; ++cell) {
    Vec3 corner[8];
    for (int k = 0; k < 8; ++k) corner[k] = mdanim::vec3(corners + 24 * cell + 3 * k);
    occupancy.add(corner, spread != 0, layers ? layers[cell] : -1, {0, ny}, occupancy.touched);
  }
  std::copy(occupancy.count.begin(), occupancy.count.end(), count);
  if (!box) return;
  std::copy_n(occupancy.touched.low, 3, box);
  std::copy_n(occupancy.touched.high, 3, box + 3);
}

MDANIM_EXPORT int mdanim_occupancy_full(int spread) { return spread ? Occupancy::FULL_SPREAD : Occupancy::FULL; }
