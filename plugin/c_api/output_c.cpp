// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions for ctypes: output values of fixes, and their names.

#include "c_api/abi.h"
#include "lammps/fix_base.h"

#include "lammps.h"
#include "modify.h"

#include <algorithm>
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

// The first rows of the array of a fix, one after the other. Returns how many there are, at most so many; 0 where there is no fix
// with an array of so many columns.
MDANIM_EXPORT int mdanim_output_rows(void *handle, const char *fix, int rows, int columns, double *to) noexcept
{
  Fix *const found = static_cast<LAMMPS *>(handle)->modify->get_fix_by_id(fix);
  if (!found || !found->array_flag || found->size_array_cols != columns) return 0;
  const int there = std::min(rows, found->size_array_rows);
  for (int row = 0; row < there; ++row)
    for (int column = 0; column < columns; ++column) *to++ = found->compute_array(row, column);
  return there;
}
