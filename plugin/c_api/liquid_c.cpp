// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions for ctypes: the liquid of fix mdanim/liquid on a LAMMPS handle. Each returns 0, or 1 with a message in
// `error`. No exception leaves them.

#include "c_api/abi.h"
#include "c_api/guarded.h"
#include "lammps/fix_mdanim_liquid.h"

#include "lammps.h"
#include "modify.h"

#include <algorithm>
#include <stdexcept>
#include <string>

using namespace LAMMPS_NS;
using mdanim::guarded;

static FixMdanimLiquid &liquid(void *handle, const char *fix)
{
  auto *found = dynamic_cast<FixMdanimLiquid *>(static_cast<LAMMPS *>(handle)->modify->get_fix_by_id(fix));
  if (!found) throw std::runtime_error(std::string("there is no fix mdanim/liquid ") + fix);
  return *found;
}

// z of every column of cells (ny, nx): the smooth surface, and the topmost liquid (NaN where a body hides
// it, minus infinity where one keeps the column dry below the surface, as a hull does its inside).
MDANIM_EXPORT int mdanim_liquid_heights(void *handle, const char *fix, double *smooth, double *raw, char *error, int error_size)
{
  return guarded(error, error_size, [&] { liquid(handle, fix).liquid().surface(smooth, raw); });
}

// Drops, the liquid that flies: x, y, z and radius of each; `rows` has room for `most`. Gives the number of drops.
MDANIM_EXPORT int mdanim_liquid_drops(void *handle, const char *fix, int most, double *rows, int *count, char *error,
                                      int error_size)
{
  return guarded(error, error_size, [&] {
    const auto drops = liquid(handle, fix).liquid().droplets();
    *count = static_cast<int>(drops.size());
    for (int n = 0; n < *count && n < most; ++n) {
      const auto &[place, radius] = drops[n];
      const double row[] = {place.x, place.y, place.z, radius};
      std::copy(row, row + 4, rows + 4 * n);
    }
  });
}

// Content of every cell (nz, ny, nx), 255 where it is solid.
MDANIM_EXPORT int mdanim_liquid_cells(void *handle, const char *fix, unsigned char *cells, char *error, int error_size)
{
  return guarded(error, error_size, [&] { liquid(handle, fix).liquid().contents(cells); });
}
