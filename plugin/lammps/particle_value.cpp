// SPDX-License-Identifier: GPL-2.0-only
// A number or d_NAME: reads the word and finds the property.

#include "lammps/particle_value.h"

#include "atom.h"
#include "error.h"
#include "fmt/format.h"
#include "utils.h"

using namespace LAMMPS_NS;

namespace mdanim {

// Index of a property of one floating-point number; -1 where there is none.
static int find(const LAMMPS *lmp, const std::string &name)
{
  int is_double = 0, columns = 0;
  const int found = lmp->atom->find_custom(name.c_str(), is_double, columns);
  return is_double && columns == 0 ? found : -1;
}

ParticleValue::ParticleValue(LAMMPS *lmp, const char *what, int iarg, const char *word) : what(what)
{
  if (utils::strmatch(word, "^d_")) {
    name = word + 2;
    index = find(lmp, name);
    if (index < 0)
      lmp->error->all(FLERR, iarg,
                      "{}: no per-particle property {} of floating-point numbers; make it with "
                      "'fix ID all property/atom {}'",
                      what, word, word);
    return;
  }
  number = utils::numeric(FLERR, word, false, lmp);
  if (!(number >= 0.0)) lmp->error->all(FLERR, iarg, "{} must be >= 0, got {}", what, word);
}

void ParticleValue::init(LAMMPS *lmp)
{
  if (constant()) return;
  index = find(lmp, name);
  if (index < 0) lmp->error->all(FLERR, "{}: the per-particle property d_{} has been removed", what, name);
  const double *value = values(lmp);
  for (int i = 0; i < lmp->atom->nlocal; ++i)
    if (!(value[i] >= 0.0))
      lmp->error->one(FLERR, "{} must be >= 0, got d_{} = {} of particle {}", what, name, value[i], lmp->atom->tag[i]);
}

const double *ParticleValue::values(LAMMPS *lmp) const { return constant() ? nullptr : lmp->atom->dvector[index]; }

// --- tables and columns ---

ParticleTable::ParticleTable(LAMMPS *lmp, const char *what, int iarg, const char *word)
{
  if (!utils::strmatch(word, "^i2_"))
    lmp->error->all(FLERR, iarg, "{} must be a per-particle property i2_NAME, got {}", what, word);
  name = word + 3;
}

int ParticleTable::width(LAMMPS *lmp) const
{
  int is_double = 0, columns = 0;
  const int index = lmp->atom->find_custom(name.c_str(), is_double, columns);
  return index < 0 || is_double ? 0 : columns;
}

int *const *ParticleTable::rows(LAMMPS *lmp) const
{
  int is_double = 0, columns = 0;
  return lmp->atom->iarray[lmp->atom->find_custom(name.c_str(), is_double, columns)];
}

bool ParticleTable::ghosts_have_rows(LAMMPS *lmp) const
{
  int is_double = 0, columns = 0, ghosts = 0;
  return lmp->atom->find_custom_ghost(name.c_str(), is_double, columns, ghosts) >= 0 && ghosts;
}

ParticleColumn::ParticleColumn(LAMMPS *lmp, const char *style, const char *keyword, int iarg, const char *word)
    : style(style), keyword(keyword)
{
  if (!utils::strmatch(word, "^d_"))
    lmp->error->all(FLERR, iarg, "{}: {} must be a per-particle property d_NAME, got {}", style, keyword, word);
  name = word + 2;
  values(lmp);
}

double *ParticleColumn::values(LAMMPS *lmp) const
{
  const int index = find(lmp, name);
  if (index < 0)
    lmp->error->all(FLERR,
                    "{}: {} names d_{}, which is not a per-particle property; make it with 'fix ID all property/atom d_{}'",
                    style, keyword, name, name);
  return lmp->atom->dvector[index];
}

}    // namespace mdanim
