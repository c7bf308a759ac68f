// SPDX-License-Identifier: GPL-2.0-only
// Refuses particles without an object.

#include "lammps/object_table.h"

#include "error.h"
#include "fix.h"
#include "fmt/format.h"
#include "lammps.h"

using namespace LAMMPS_NS;

void mdanim::need_object(const Fix *fix, LAMMPS *lmp, int i, const char *or_else)
{
  const Atom &atom = *lmp->atom;
  if (atom.molecule[i] > 0) return;
  lmp->error->one(FLERR,
                  "fix {} {}: particle {} belongs to no object, its molecule ID is {}; give it one > 0 ('set group … mol …'){}",
                  fix->id, fix->style, atom.tag[i], atom.molecule[i], or_else);
}
