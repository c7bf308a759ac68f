// SPDX-License-Identifier: GPL-2.0-only
// Number or d_NAME: reading the word, finding the property.

#include "styles/particle_value.h"

#include "atom.h"
#include "error.h"
#include "fmt/format.h"
#include "utils.h"

using namespace LAMMPS_NS;

namespace mdanim {

ParticleValue::ParticleValue(LAMMPS *lmp, const char *what, int iarg, const char *word) : what(what)
{
  if (utils::strmatch(word, "^d_")) {
    name = word + 2;
    if (find(lmp) < 0)
      lmp->error->all(FLERR, iarg,
                      "{}: no per-particle property {} of floating-point numbers; make it with "
                      "'fix ID all property/atom {}'",
                      what, word, word);
    return;
  }
  number = utils::numeric(FLERR, word, false, lmp);
  if (!(number >= 0.0)) lmp->error->all(FLERR, iarg, "{} must be >= 0, got {}", what, word);
}

int ParticleValue::find(LAMMPS *lmp) const
{
  int is_double = 0, columns = 0;
  const int found = lmp->atom->find_custom(name.c_str(), is_double, columns);
  return is_double && columns == 0 ? found : -1;
}

void ParticleValue::init(LAMMPS *lmp)
{
  if (constant()) return;
  index = find(lmp);
  if (index < 0) lmp->error->all(FLERR, "{}: the per-particle property d_{} has been removed", what, name);
  const double *value = values(lmp);
  for (int i = 0; i < lmp->atom->nlocal; ++i)
    if (!(value[i] >= 0.0))
      lmp->error->one(FLERR, "{} must be >= 0, got d_{} = {} of particle {}", what, name, value[i], lmp->atom->tag[i]);
}

const double *ParticleValue::values(LAMMPS *lmp) const { return constant() ? nullptr : lmp->atom->dvector[index]; }

}    // namespace mdanim
