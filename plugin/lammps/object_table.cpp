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

void mdanim::need_molecules(const Fix *fix, LAMMPS *lmp, const char *word, const std::vector<int> &ids)
{
  if (ids.empty()) return;
  const Atom &atom = *lmp->atom;
  ObjectTable present;
  present.make(lmp->world, {atom.molecule, atom.molecule + atom.nlocal});
  for (const int one : ids)
    if (present.number_of(one) == ObjectTable::NONE)
      lmp->error->all(FLERR, "fix {} {}: {} names molecule {}, and no particle has this ID", fix->id, fix->style, word, one);
}
