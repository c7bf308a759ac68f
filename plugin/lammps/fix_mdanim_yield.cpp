// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/yield: one loop over the bonds that may yield, which are listed when LAMMPS makes its lists. A bond is stored
// at both ends, which find the same.

#include "lammps/fix_mdanim_yield.h"

#include "lammps/bond_mdanim_harmonic.h"
#include "lammps/keywords.h"
#include "numbers/real.h"
#include "numbers/stopwatch.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "modify.h"

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static const char *const STYLE = "fix mdanim/yield";

// fix ID group mdanim/yield grown NAME bears NAME keyword values ...
FixMdanimYield::FixMdanimYield(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg), rings(lmp, STYLE), losses(lmp)
{
  need(OPEN_BOX | ATOM_MAP);
  need_words(lmp, STYLE, "fix ID group mdanim/yield", "grown NAME bears NAME", narg - 3);
  const auto into = [](std::string &name) { return [&name](int at, char **words) { name = words[at + 1]; }; };
  const auto read = [this](int at, char **words) { rings.read(words[at + 1]); };
  const auto of_rings = [this](int at, char **words) { rings.set_property(words[at + 1]); };
  const std::vector<Keyword> known = {{"grown", "NAME", "", into(grown)},
                                      {"bears", "NAME", "", into(bears)},
                                      {"free", "NAME", "", into(free)},
                                      {"bent", "NAME", "", of_rings},
                                      {"rings", "FILE", "", read}};
  for (int iarg = 3; iarg < narg;) iarg += take_keyword(lmp, STYLE, known, iarg, narg, arg);
  if (grown.empty()) error->all(FLERR, "{}: the keyword grown is missing; write grown NAME", STYLE);
  if (bears.empty()) error->all(FLERR, "{}: the keyword bears is missing; write bears NAME", STYLE);
  if (rings.has_rings() != rings.has_property())
    error->all(FLERR, "{}: what bends of layers stay is told by both bent NAME and rings FILE", STYLE);
  if (rings.has_rings()) need(OPEN_BOX | ATOM_MAP | OBJECTS);
  find_properties();
  comm->ghost_velocity = 1;    // the account sees what both ends of a spring did
  tell({{"energy", true, [this] { return sum(losses.total()); }}, clock()});
}

const FixMdanimYield *FixMdanimYield::of(LAMMPS *lmp)
{
  for (Fix *fix : lmp->modify->get_fix_list())
    if (const auto *one = dynamic_cast<const FixMdanimYield *>(fix)) return one;
  return nullptr;
}

int FixMdanimYield::setmask() { return POST_NEIGHBOR | PRE_FORCE | POST_FORCE | FINAL_INTEGRATE; }

// A property with a number for each bond that a particle has room for.
int FixMdanimYield::find(const std::string &property) const
{
  int is_double = 0, columns = 0;
  const int found = atom->find_custom(property.c_str(), is_double, columns), needed = atom->bond_per_atom;
  if (found < 0 || !is_double || columns < needed)
    error->all(FLERR, "{}: there is no per-particle property d2_{} {}; make it with 'fix ID all property/atom d2_{} {}'", STYLE,
               property, needed, property, needed);
  return found;
}

void FixMdanimYield::find_properties()
{
  of_growths = find(grown);
  of_most = find(bears);
  if (!free.empty()) of_lengths = find(free);
}

double **FixMdanimYield::growths() const { return atom->darray[of_growths]; }

void FixMdanimYield::init()
{
  FixBase::init();
  springs = dynamic_cast<BondMdanimHarmonic *>(force->bond);
  if (!springs || springs->are_given())
    error->all(FLERR, "{}: needs bond_style mdanim/harmonic, with bonds that particles have themselves", name());
  find_properties();
  if (rings.has_rings()) rings.init();
}

void FixMdanimYield::setup_post_neighbor()
{
  rings.begin();
  watch();
}

// A bond yields where an end is in the group; then both ends follow.
void FixMdanimYield::watch()
{
  const Lap lap(seconds);
  watched.clear();
  double *const *const most = atom->darray[of_most];
  for (int i = 0; i < atom->nlocal; ++i)
    for (int b = 0; b < atom->num_bond[i]; ++b) {
      const int type = atom->bond_type[i][b], j = atom->map(atom->bond_atom[i][b]);
      if (!(most[i][b] > 0.0) || type <= 0) continue;
      if (j < 0) springs->lost_partner(i, static_cast<int>(atom->bond_atom[i][b]));
      if (!((atom->mask[i] | atom->mask[j]) & groupbit)) continue;
      const Spring &spring = springs->springs()[type];
      const double length = of_lengths < 0 ? spring.r0 : atom->darray[of_lengths][i][b];
      watched.push_back({i, b, j, spring.K, spring.r0, length, most[i][b], 0.0});
    }
  rings.watch(groupbit);
}

bool FixMdanimYield::is_gone(const YieldBond &one) const { return atom->bond_type[one.i][one.slot] <= 0; }

double FixMdanimYield::now(const YieldBond &one) const
{ return root(floored_square(vec3(atom->x[one.i]) - vec3(atom->x[one.j]))); }

LoadFree FixMdanimYield::first(const YieldBond &one) const { return {{one.K, one.r0, 0.0}, one.length}; }

// No time passes: nothing yields.
void FixMdanimYield::setup(int vflag)
{
  for (YieldBond &one : watched) one.factor = growth_factor(one.K, more(one.i, one.slot), now(one));
  rings.look();
  post_force(vflag);
}

void FixMdanimYield::pre_force(int)
{
  const Lap lap(seconds);
  for (YieldBond &one : watched) {
    if (is_gone(one)) continue;
    const double r = now(one), before = more(one.i, one.slot);
    const double after = mdanim::grown(one.length, r - one.length, before, one.most);
    if (after != before) {
      losses.count(one.i, one.j, grown_spring(first(one), before), 1.0);
      losses.count(one.i, one.j, grown_spring(first(one), after), -1.0);
      growths()[one.i][one.slot] = after;
    }
    one.factor = growth_factor(one.K, after, r);
  }
  rings.yield(losses);
}

void FixMdanimYield::post_force(int)
{
  const Lap lap(seconds);
  for (const YieldBond &one : watched)
    if (one.factor != 0.0 && !is_gone(one)) add_to(atom->f[one.i], one.factor * (vec3(atom->x[one.i]) - vec3(atom->x[one.j])));
  rings.push();
}

// All forces of the step are there.
void FixMdanimYield::final_integrate() { losses.close(groupbit); }

// Half of the energy of a bond at either end.
double FixMdanimYield::compute_scalar()
{
  double here = 0.0;
  for (const YieldBond &one : watched)
    if (const double growth = more(one.i, one.slot); growth != 0.0 && !is_gone(one))
      here += 0.5 * growth_energy(first(one), growth, now(one));
  return sum(here + rings.energy());
}

double FixMdanimYield::memory_usage() { return static_cast<double>(watched.capacity() * sizeof(YieldBond) + rings.bytes()); }
