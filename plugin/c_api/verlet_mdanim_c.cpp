// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions on run_style verlet/mdanim, for ctypes.

#include "c_api/abi.h"
#include "lammps/verlet_mdanim.h"

#include "lammps.h"
#include "update.h"

using namespace LAMMPS_NS;

static const VerletMdanim *run_of(void *handle)
{ return dynamic_cast<VerletMdanim *>(static_cast<LAMMPS *>(handle)->update->integrate); }

// Number of steps that this rank has taken by a pass over its blocks; 0 with another run style.
MDANIM_EXPORT long long mdanim_passes(void *handle) noexcept
{
  const VerletMdanim *run = run_of(handle);
  return run ? run->passes() : 0;
}

// Number of ranges that threads share in the latest pass of this rank; 0 before the first pass.
MDANIM_EXPORT int mdanim_ranges(void *handle) noexcept
{
  const VerletMdanim *run = run_of(handle);
  return run ? run->ranges() : 0;
}

// Number of points near planes whose contacts the latest pass of this rank computed itself; 0 before the first pass.
MDANIM_EXPORT long mdanim_points_at_planes(void *handle) noexcept
{
  const VerletMdanim *run = run_of(handle);
  return run ? run->points_at_planes() : 0;
}

// The set of vector instructions that this rank's passes use; empty before the first pass.
MDANIM_EXPORT const char *mdanim_width(void *handle) noexcept
{
  const VerletMdanim *run = run_of(handle);
  return run ? run->width() : "";
}

// Number of particles that were held back in passes of this rank and moved one by one, all passes together.
MDANIM_EXPORT long long mdanim_held_back(void *handle) noexcept
{
  const VerletMdanim *run = run_of(handle);
  return run ? run->held_back() : 0;
}
