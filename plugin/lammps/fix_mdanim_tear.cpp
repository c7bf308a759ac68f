// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/tear: one loop over the bonds of particles. A bond is stored at both ends, which decide alike.

#include "lammps/fix_mdanim_tear.h"

#include "lammps/bond_mdanim_harmonic.h"
#include "lammps/keywords.h"
#include "numbers/stopwatch.h"

#include "atom.h"
#include "error.h"
#include "force.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <iterator>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static const char *const STYLE = "fix mdanim/tear";
static constexpr int REST = 3;    // values of a Remainder

// fix ID group mdanim/tear limit d2_NAME second d2_NAME stored d2_NAME rest d2_NAME torn d2_NAME
FixMdanimTear::FixMdanimTear(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg)
{
  need_words(lmp, STYLE, "fix ID group mdanim/tear", "limit d2_NAME second d2_NAME stored d2_NAME rest d2_NAME torn d2_NAME",
             narg - 3);
  const struct {
    const char *word;
    std::string *name;
    int each;
  } words[] = {{"limit", &limit, 1}, {"second", &second, 1}, {"stored", &stored, 1}, {"rest", &rest, REST}, {"torn", &torn, 1}};
  for (int iarg = 3; iarg < narg; iarg += 2) {
    const auto *const found =
        std::find_if(std::begin(words), std::end(words), [&](const auto &one) { return strcmp(arg[iarg], one.word) == 0; });
    if (found == std::end(words))
      error->all(FLERR, iarg, "{}: unknown keyword {}; limit, second, stored, rest and torn are known", STYLE, arg[iarg]);
    if (iarg + 1 >= narg || !utils::strmatch(arg[iarg + 1], "^d2_"))
      error->all(FLERR, iarg, "{}: {} must be followed by a per-particle property d2_NAME", STYLE, arg[iarg]);
    *found->name = arg[iarg + 1] + 3;
    rows(*found->name, found->each);
  }
  for (const auto &one : words)
    if (one.name->empty()) error->all(FLERR, "{}: the keyword {} is missing; write {} d2_NAME", STYLE, one.word, one.word);
  need(OPEN_BOX | ATOM_MAP);
  tell({{"energy", true, [this] { return sum(lost); }}, clock()});
}

int FixMdanimTear::setmask() { return PRE_FORCE | POST_FORCE; }

// A property with room for some values of each bond of a particle.
double **FixMdanimTear::rows(const std::string &name, int each) const
{
  int is_double = 0, columns = 0;
  const int index = atom->find_custom(name.c_str(), is_double, columns), needed = each * atom->bond_per_atom;
  if (index < 0 || !is_double || columns < needed)
    error->all(FLERR,
               "{}: there is no per-particle property d2_{} with {} columns; make it with 'fix ID all property/atom d2_{} {}'",
               STYLE, name, needed, name, needed);
  return atom->darray[index];
}

FixMdanimTear::BondValues FixMdanimTear::values() const
{ return {rows(limit), rows(second), rows(stored), rows(rest, REST), rows(torn)}; }

void FixMdanimTear::init()
{
  FixBase::init();
  springs = dynamic_cast<BondMdanimHarmonic *>(force->bond);
  if (!springs || springs->are_given())
    error->all(FLERR, "{}: needs bond_style mdanim/harmonic, with bonds that particles have themselves", name());
  springs->partial_flag = 1;    // LAMMPS then does not look for the partners of bonds that are gone
}

// --- what breaks ---

// Place of a particle near particle i.
Vec3 FixMdanimTear::place(int i, tagint of) const
{
  const int j = atom->map(of);
  if (j < 0) springs->lost_partner(i, static_cast<int>(of));
  return vec3(atom->x[j]);
}

Vec3 FixMdanimTear::apart(int i, int b) const { return vec3(atom->x[i]) - place(i, atom->bond_atom[i][b]); }

// Whether bond b of particle i breaks here: by its own length; or where it has a second limit, by the lengths from its lower end
// to the particle with the next tag, and from there to its upper one. Differences of the same places at either end: the same
// bits.
bool FixMdanimTear::breaks(int i, int b, const BondValues &now) const
{
  if (now.limit[i][b] == 0.0 || now.torn[i][b] != 0.0) return false;
  const tagint own = atom->tag[i], other = atom->bond_atom[i][b];
  const tagint low = std::min(own, other), high = std::max(own, other);
  if (now.second[i][b] == 0.0) return is_too_long(place(i, low) - place(i, high), now.limit[i][b]);
  const Vec3 middle = place(i, low + 1);
  return is_too_long(place(i, low) - middle, now.limit[i][b]) || is_too_long(middle - place(i, high), now.second[i][b]);
}

// The property torn comes from records, or from a run before: bonds follow it.
void FixMdanimTear::setup_pre_force(int)
{
  const BondValues now = values();
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    for (int b = 0; b < atom->num_bond[i]; ++b) {
      int &type = atom->bond_type[i][b];
      type = now.torn[i][b] != 0.0 ? -std::abs(type) : std::abs(type);
    }
  }
  springs->change_bonds();
}

void FixMdanimTear::pre_force(int)
{
  const Lap lap(seconds);
  const BondValues now = values();
  bool any = false;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    breaking.clear();
    for (int b = 0; b < atom->num_bond[i]; ++b)
      if (breaks(i, b, now)) breaking.push_back(b);
    if (breaking.empty()) continue;
    lost += account(i, now);
    for (const int b : breaking) {
      now.torn[i][b] = 1.0;
      atom->bond_type[i][b] *= -1;
    }
    lost -= account(i, now);
    any = true;
  }
  if (any) springs->change_bonds();
}

// Part of particle i in V + F/2 . dt v of all its springs and what remains of others.
double FixMdanimTear::account(int i, const BondValues &now) const
{
  const Vec3 way = update->dt * vec3(atom->v[i]);
  double all = 0.0;
  for (int b = 0; b < atom->num_bond[i]; ++b) {
    if (now.torn[i][b] != 0.0) continue;
    const Vec3 to = apart(i, b);
    all += lost_with(springs->springs()[atom->bond_type[i][b]], now.stored[i][b], to, way);
    if (const int many = remaining(i, b, now)) {
      const Remainder left = remainder(i, b, now);
      all += many * lost_with(left.spring(), left.stored, to, way);
    }
  }
  return all;
}

// --- what remains ---

Remainder FixMdanimTear::remainder(int i, int b, const BondValues &now)
{
  const double *const value = now.rest[i] + REST * b;
  return {value[0], value[1], value[2]};
}

// How many springs over link b of particle i and a link that is gone there were: one where the next link on this side is gone,
// one where that on the other side is, with which a spring of i over both has let go.
int FixMdanimTear::remaining(int i, int b, const BondValues &now) const
{
  if (now.torn[i][b] != 0.0 || remainder(i, b, now).k == 0.0) return 0;
  const tagint own = atom->tag[i], other = atom->bond_atom[i][b], behind = 2 * own - other, beyond = 2 * other - own;
  int many = 0;
  for (int k = 0; k < atom->num_bond[i]; ++k) {
    const tagint to = atom->bond_atom[i][k];
    if (now.torn[i][k] != 0.0 && (to == behind || to == beyond)) ++many;
  }
  return many;
}

template <class Visit> void FixMdanimTear::each_remainder(Visit visit) const
{
  const BondValues now = values();
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    const double *const gone = now.torn[i];
    if (std::none_of(gone, gone + atom->num_bond[i], [](double one) { return one != 0.0; })) continue;
    for (int b = 0; b < atom->num_bond[i]; ++b)
      if (const int many = remaining(i, b, now)) visit(i, b, many, remainder(i, b, now));
  }
}

void FixMdanimTear::pull() const
{
  each_remainder([this](int i, int b, int many, const Remainder &left) {
    add_to(atom->f[i], static_cast<double>(many) * force_of(left.spring(), apart(i, b)));
  });
}

void FixMdanimTear::post_force(int)
{
  const Lap lap(seconds);
  pull();
}

// Energy of what remains; half of it at either end.
double FixMdanimTear::compute_scalar()
{
  double here = 0.0;
  each_remainder([&](int i, int b, int many, const Remainder &left) {
    const Vec3 to = apart(i, b);
    here += 0.5 * many * left.energy(std::sqrt(dot(to, to)));
  });
  return sum(here);
}
