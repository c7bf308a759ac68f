// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions on run_style verlet/mdanim, for ctypes.

#include "abi.h"
#include "verlet_mdanim.h"

#include "lammps.h"
#include "update.h"

using namespace LAMMPS_NS;

static VerletMdanim *style(void *handle)
{
  return dynamic_cast<VerletMdanim *>(static_cast<LAMMPS *>(handle)->update->integrate);
}

// How many steps this rank has taken by a pass over its blocks; 0 with another run style.
MDANIM_EXPORT long long mdanim_passes(void *handle)
{
  const auto *run = style(handle);
  return run ? run->passes() : 0;
}

// From now on every run writes the forces of the step before its last to `into`, (n, 3) for the n particles of this rank; null: no more.
// Returns 0, or 1 with another run style.
MDANIM_EXPORT int mdanim_watch_forces(void *handle, double *into)
{
  auto *run = style(handle);
  if (run) run->watch_forces(into);
  return run ? 0 : 1;
}
