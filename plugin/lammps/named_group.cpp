// SPDX-License-Identifier: GPL-2.0-only
// A group by its name.

#include "lammps/named_group.h"

#include "error.h"
#include "group.h"

using namespace LAMMPS_NS;

namespace mdanim {

NamedGroup::NamedGroup(LAMMPS *lmp, const std::string &style, int iarg, const char *word) : style(style), name(word)
{
  if (lmp->group->find(name) < 0) lmp->error->all(FLERR, iarg, "{}: there is no group {}; make it before this fix", style, name);
  init(lmp);
}

void NamedGroup::init(LAMMPS *lmp)
{
  if (!given()) return;
  const int index = lmp->group->find(name);
  if (index < 0) lmp->error->all(FLERR, "{}: group {} has been deleted; make it again, or define the fix anew", style, name);
  number = lmp->group->bitmask[index];
}

}    // namespace mdanim
