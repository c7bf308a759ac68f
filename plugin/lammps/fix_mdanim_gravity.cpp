// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/gravity: one loop over the particles.

#include "lammps/fix_mdanim_gravity.h"

#include "lammps/keywords.h"
#include "lammps/particle_value.h"
#include "numbers/stopwatch.h"

#include "atom.h"
#include "error.h"
#include "utils.h"

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

// fix ID group mdanim/gravity gx gy gz   [force/mass, as in LAMMPS's own fix gravity]
FixMdanimGravity::FixMdanimGravity(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg)
{
  dynamic_group_allow = 1;
  tell({clock()});

  need_words(lmp, "fix mdanim/gravity", "fix ID group mdanim/gravity", "gx gy gz", narg - 3);
  if (narg > 6) error->all(FLERR, 6, "fix mdanim/gravity: gx gy gz are all it takes, got also {}", arg[6]);
  g = {utils::numeric(FLERR, arg[3], false, lmp), utils::numeric(FLERR, arg[4], false, lmp),
       utils::numeric(FLERR, arg[5], false, lmp)};
}

int FixMdanimGravity::setmask() { return POST_FORCE; }

void FixMdanimGravity::setup(int vflag) { post_force(vflag); }

double FixMdanimGravity::pulled(int i) const
{ return atom->mask[i] & groupbit ? mass_of(atom->rmass, atom->mass, atom->type, i) : 0.0; }

void FixMdanimGravity::post_force(int)
{
  const Lap lap(seconds);
  double *const *f = atom->f;
  for (int i = 0; i < atom->nlocal; ++i)
    if (atom->mask[i] & groupbit) add_to(f[i], pulled(i) * g);
}

// Energy, zero at the origin.
double FixMdanimGravity::compute_scalar()
{
  double here = 0.0;
  for (int i = 0; i < atom->nlocal; ++i) here -= pulled(i) * dot(g, vec3(atom->x[i]));
  return sum(here);
}
