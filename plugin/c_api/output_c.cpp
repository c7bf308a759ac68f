// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions for ctypes: names of the output values of fixes.

#include "c_api/abi.h"
#include "lammps/fix_base.h"

#include "lammps.h"
#include "modify.h"

#include <vector>

using namespace LAMMPS_NS;

static const std::vector<mdanim::Output> *outputs(void *handle, const char *fix)
{
  const auto *found = dynamic_cast<const mdanim::FixBase *>(static_cast<LAMMPS *>(handle)->modify->get_fix_by_id(fix));
  return found ? &found->outputs() : nullptr;
}

// Name of the n-th entry, from 0, of the vector of a fix of this package; null beyond the last, and for other fixes.
MDANIM_EXPORT const char *mdanim_output_name(void *handle, const char *fix, int n) noexcept
{
  const auto *all = outputs(handle, fix);
  return all && n >= 0 && n < static_cast<int>(all->size()) ? (*all)[n].name.c_str() : nullptr;
}

// Place of an entry of that name, from 0; -1 where there is none.
MDANIM_EXPORT int mdanim_output_place(void *handle, const char *fix, const char *name) noexcept
{
  int place = 0;
  if (const auto *all = outputs(handle, fix))
    for (const mdanim::Output &one : *all) {
      if (one.name == name) return place;
      ++place;
    }
  return -1;
}
