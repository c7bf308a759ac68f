// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions on run_style verlet/mdanim, for ctypes.

#include "abi.h"
#include "verlet_mdanim.h"

#include "lammps.h"
#include "update.h"

using namespace LAMMPS_NS;

// How many steps this rank has taken by a pass over its blocks; 0 with another run style.
MDANIM_EXPORT long long mdanim_passes(void *handle)
{
  const auto *run = dynamic_cast<VerletMdanim *>(static_cast<LAMMPS *>(handle)->update->integrate);
  return run ? run->passes() : 0;
}
