// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions for ctypes: the liquid of fix mdanim/liquid on a LAMMPS handle. No exception leaves them.

#include "c_api/abi.h"
#include "styles/fix_mdanim_liquid.h"

#include "lammps.h"
#include "modify.h"

#include <cstdio>
#include <cstring>
#include <exception>

using namespace LAMMPS_NS;

static FixMdanimLiquid *liquid(void *handle, const char *fix)
{ return dynamic_cast<FixMdanimLiquid *>(static_cast<LAMMPS *>(handle)->modify->get_fix_by_id(fix)); }

// z of every column of cells (ny, nx): the smooth surface, and the topmost liquid (NaN where a body hides
// it, minus infinity where one keeps the column dry below the surface, as a hull does its inside). Returns
// 0, or 1 when there is no such fix.
MDANIM_EXPORT int mdanim_liquid_heights(void *handle, const char *fix, double *smooth, double *raw)
{
  const FixMdanimLiquid *found = liquid(handle, fix);
  if (!found) return 1;
  found->surface(smooth, raw);
  return 0;
}

// Content of every cell (nz, ny, nx), 255 where it is solid. Returns 0, or 1 when there is no such fix.
MDANIM_EXPORT int mdanim_liquid_cells(void *handle, const char *fix, unsigned char *cells)
{
  const FixMdanimLiquid *found = liquid(handle, fix);
  if (!found) return 1;
  found->contents(cells);
  return 0;
}

// Bytes of the liquid's state, -1 when there is no such fix. All ranks call it and the next two together.
MDANIM_EXPORT long long mdanim_liquid_state_size(void *handle, const char *fix)
{
  FixMdanimLiquid *found = liquid(handle, fix);
  return found ? static_cast<long long>(found->state().size()) : -1;
}

MDANIM_EXPORT int mdanim_liquid_get_state(void *handle, const char *fix, unsigned char *bytes)
{
  FixMdanimLiquid *found = liquid(handle, fix);
  if (!found) return 1;
  const auto state = found->state();
  memcpy(bytes, state.data(), state.size());
  return 0;
}

// To be called before the setup of a run. Returns 0, or 1 with a message in `error`.
MDANIM_EXPORT int mdanim_liquid_set_state(void *handle, const char *fix, const unsigned char *bytes, long long size, char *error,
                                          int error_size)
{
  try {
    FixMdanimLiquid *found = liquid(handle, fix);
    const std::string why = found ? found->set_state(bytes, size) : std::string("there is no fix mdanim/liquid ") + fix;
    if (why.empty()) return 0;
    snprintf(error, error_size, "%s", why.c_str());
  } catch (const std::exception &e) {
    snprintf(error, error_size, "%s", e.what());
  }
  return 1;
}
