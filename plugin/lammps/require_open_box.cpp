// SPDX-License-Identifier: GPL-2.0-only

#include "lammps/require_open_box.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "fmt/format.h"
#include "lammps.h"
#include "neighbor.h"
#include "update.h"
#include "utils.h"

#include <string>

using namespace LAMMPS_NS;

namespace mdanim {

void need_objects_in_open_box(const Fix *fix, LAMMPS *lmp, const char *missed)
{
  const Domain &domain = *lmp->domain;
  const Neighbor &neighbor = *lmp->neighbor;
  const auto refuse = [&](const std::string &why) { lmp->error->all(FLERR, "fix {} {}: {}", fix->id, fix->style, why); };
  if (utils::strmatch(lmp->update->integrate_style, "^respa")) refuse("run_style respa is not supported; use run_style verlet");
  if (domain.dimension != 3) refuse("the box has 2 dimensions, 3 are needed; use 'dimension 3'");
  if (domain.triclinic) refuse("the box is triclinic; use an orthogonal one");
  if (domain.xperiodic || domain.yperiodic || domain.zperiodic)
    refuse("the box is periodic; put 'boundary s s s' (or f) before the box is made");
  if (!lmp->atom->molecule_flag)
    refuse("objects are told apart by molecule IDs; use 'atom_style bond' or 'fix ID all property/atom mol'");
  if (neighbor.every != 1 || neighbor.delay != 0 || neighbor.build_once)
    refuse(fmt::format("{} between two rebuilds; use 'neigh_modify every 1 delay 0 check yes once no'", missed));
}

void need_object(const Fix *fix, LAMMPS *lmp, int i, const char *or_else)
{
  const Atom &atom = *lmp->atom;
  if (atom.molecule[i] > 0) return;
  lmp->error->one(FLERR,
                  "fix {} {}: particle {} belongs to no object, its molecule ID is {}; give it one > 0 ('set group … mol …'){}",
                  fix->id, fix->style, atom.tag[i], atom.molecule[i], or_else);
}

}    // namespace mdanim
