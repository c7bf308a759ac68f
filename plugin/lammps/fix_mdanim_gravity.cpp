// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/gravity: one loop over the particles.

#include "lammps/fix_mdanim_gravity.h"

#include "lammps/keywords.h"
#include "lammps/particle_value.h"
#include "numbers/stopwatch.h"

#include "atom.h"
#include "error.h"
#include "update.h"
#include "utils.h"

#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

// fix ID group mdanim/gravity gx gy gz   [force/mass, as in LAMMPS's own fix gravity]
// fix ID group mdanim/gravity path T gx gy gz T gx gy gz ...
FixMdanimGravity::FixMdanimGravity(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg)
{
  dynamic_group_allow = 1;
  tell({{"work", true, [this] { return sum(work.total()); }}, clock()});
  if (narg > 3 && strcmp(arg[3], "path") == 0) {
    read_path(narg, arg);
    return;
  }
  need_words(lmp, "fix mdanim/gravity", "fix ID group mdanim/gravity", "gx gy gz", narg - 3);
  if (narg > 6) error->all(FLERR, 6, "fix mdanim/gravity: gx gy gz are all it takes, got also {}", arg[6]);
  g = {utils::numeric(FLERR, arg[3], false, lmp), utils::numeric(FLERR, arg[4], false, lmp),
       utils::numeric(FLERR, arg[5], false, lmp)};
}

// Points of a path: a time and an acceleration each.
void FixMdanimGravity::read_path(int narg, char **arg)
{
  need_words(lmp, "fix mdanim/gravity", "fix ID group mdanim/gravity path", "T gx gy gz", narg - 4);
  if ((narg - 4) % 4)
    error->all(FLERR, narg - 1, "fix mdanim/gravity: each point of a path is T gx gy gz, and {} words are too many",
               (narg - 4) % 4);
  for (int i = 4; i < narg; i += 4) {
    double value[4];
    for (int k = 0; k < 4; ++k) value[k] = utils::numeric(FLERR, arg[i + k], false, lmp);
    if (!path.empty() && !(value[0] > path.last_time()))
      error->all(FLERR, i, "fix mdanim/gravity: times of a path ascend, got {} behind {}", value[0], path.last_time());
    path.append(value[0], {value[1], value[2], value[3]});
  }
  g = path.at(now());
}

// Simulated time by the step alone: LAMMPS adds up its own over runs, and rounds otherwise after other runs.
double FixMdanimGravity::now() const { return static_cast<double>(update->ntimestep) * update->dt; }

Vec3 FixMdanimGravity::momentum() const
{
  Vec3 all;
  for (int i = 0; i < atom->nlocal; ++i) all += pulled(i) * vec3(atom->v[i]);
  return all;
}

int FixMdanimGravity::setmask() { return POST_FORCE; }

void FixMdanimGravity::setup(int)
{
  if (!steady()) g = path.at(now());
  work.begin(g);
  pull();
}

double FixMdanimGravity::pulled(int i) const
{ return atom->mask[i] & groupbit ? mass_of(atom->rmass, atom->mass, atom->type, i) : 0.0; }

void FixMdanimGravity::post_force(int)
{
  const Lap lap(seconds);
  // Velocities are those of half a step before: what has moved the particles here.
  if (!steady()) worked(dot(turn_to_step(), momentum()));
  pull();
}

Vec3 FixMdanimGravity::turn_to_step()
{
  g = path.at(now());
  return work.turn(g);
}

void FixMdanimGravity::worked(double power) { work.add(power, update->dt); }

void FixMdanimGravity::pull() const
{
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
