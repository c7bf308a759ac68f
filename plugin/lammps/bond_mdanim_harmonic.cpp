// SPDX-License-Identifier: GPL-2.0-only
// bond_style mdanim/harmonic. Every particle sums its own bonds in an order given by its partners' tags, lower tags from the
// lowest up, higher ones from the highest down, and adds the two sums to its force once. So the bits of a force depend on neither
// the order of particles nor the ranks that hold them. This file has coefficients and rows; forces are in
// bond_mdanim_harmonic_forces.cpp.

#include "lammps/bond_mdanim_harmonic.h"
#include "lammps/keywords.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "memory.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

using namespace LAMMPS_NS;
using namespace mdanim;

static constexpr int RESTART_VERSION = 1;

static bigint versions = 0;    // shared by the springs of all instances

BondMdanimHarmonic::BondMdanimHarmonic(LAMMPS *lmp) : Bond(lmp), kernels(widest_kernels()) {}

BondMdanimHarmonic::~BondMdanimHarmonic()
{
  if (allocated) memory->destroy(setflag);
}

void BondMdanimHarmonic::allocate()
{
  allocated = 1;
  const int n = atom->nbondtypes;
  memory->create(setflag, n + 1, "bond:setflag");
  std::fill(setflag, setflag + n + 1, 0);
  spring.assign(n + 1, Spring());
}

// bond_coeff TYPE K r0 [c]
void BondMdanimHarmonic::coeff(int narg, char **arg)
{
  need_words(lmp, "bond_style mdanim/harmonic", "bond_coeff TYPE", "K r0 [c]", narg - 1);
  if (narg > 4) error->all(FLERR, 4, "bond_style mdanim/harmonic: coefficients are K r0 [c], got {} words", narg - 1);
  if (!allocated) allocate();

  int low, high;
  utils::bounds(FLERR, arg[0], 1, atom->nbondtypes, low, high, error);
  Spring s;
  s.K = utils::numeric(FLERR, arg[1], false, lmp);
  s.r0 = utils::numeric(FLERR, arg[2], false, lmp);
  if (narg == 4) s.c = utils::numeric(FLERR, arg[3], false, lmp);
  if (!(s.K >= 0.0)) error->all(FLERR, 1, "bond_style mdanim/harmonic: K must be >= 0, got {}", arg[1]);
  if (!(s.r0 >= 0.0)) error->all(FLERR, 2, "bond_style mdanim/harmonic: r0 must be >= 0, got {}", arg[2]);
  if (!(s.c >= 0.0)) error->all(FLERR, 3, "bond_style mdanim/harmonic: c must be >= 0, got {}", arg[3]);
  for (int type = low; type <= high; ++type) {
    spring[type] = s;
    setflag[type] = 1;
  }
  coefficients_may_differ = true;
}

void BondMdanimHarmonic::init_style()
{
  if (force->newton_bond)
    error->all(FLERR, "bond_style mdanim/harmonic: every bond must be stored at both ends; put 'newton off' (or "
                      "'newton on off') before the box is made");
  if (atom->molecular != Atom::MOLECULAR)
    error->all(FLERR,
               "bond_style mdanim/harmonic: particles must have their bonds themselves; use 'atom_style bond', not template");
  if (atom->map_style == Atom::MAP_NONE)
    error->all(FLERR, "bond_style mdanim/harmonic: needs an atom map; put 'atom_modify map array' before the box is made");
  damped = has_dashpots();
  const bool ghosts = comm->nprocs > 1 || domain->xperiodic || domain->yperiodic || domain->zperiodic;
  if (damped && ghosts && !comm->ghost_velocity)
    error->all(FLERR, "bond_style mdanim/harmonic: a dashpot (c > 0) needs the velocities of particles of other ranks; "
                      "use 'comm_modify vel yes'");
  const auto &fixes = modify->get_fix_list();
  bonds_are_swapped =
      std::any_of(fixes.begin(), fixes.end(), [](const Fix *fix) { return utils::strmatch(fix->style, "^bond/"); });
  coefficients_may_differ = true;
}

// --- rows ---

// Whether tags or bonds differ from those that the rows were made from, which are then stored. During a run only fixes change
// bonds; except for fixes of the bond/ family every change shows in the number of a particle's bonds.
bool BondMdanimHarmonic::source_changed()
{
  const int nlocal = atom->nlocal;
  if (given) {
    if (nlocal != rows.size() || atom->nghost || !std::is_sorted(atom->tag, atom->tag + nlocal))
      error->all(FLERR,
                 "bond_style mdanim/harmonic: springs were given for {} particles, in the order of their tags and without "
                 "ghosts; at step {} there are {}, with {} ghosts, or in another order; if the bodies fly apart, lower the "
                 "time step",
                 rows.size(), update->ntimestep, nlocal, atom->nghost);
    return false;
  }
  const bool partners_may_differ = update->setupflag || bonds_are_swapped;
  bool same = atom->nghost == 0 && static_cast<int>(source.tag.size()) == nlocal &&
              std::equal(source.tag.begin(), source.tag.end(), atom->tag) &&
              std::equal(source.count.begin(), source.count.end(), atom->num_bond);
  Row row;
  for (int i = 0; same && partners_may_differ && i < nlocal; ++i) same = !has_changed(i, row);
  if (same) return false;

  source = Source();
  if (atom->nghost) return true;    // indices of ghosts change with every rebuild
  source.tag.assign(atom->tag, atom->tag + nlocal);
  source.count.assign(atom->num_bond, atom->num_bond + nlocal);
  return true;
}

bool BondMdanimHarmonic::has_changed(int i, Row &row) const
{
  look_up(i, upper_only, row);
  return !rows.is(i, row);
}

void BondMdanimHarmonic::make_rows()
{
  const bool halves = halves_suffice();
  SpringRows now(atom->nlocal);
  Row row;
  for (int i = 0; i < atom->nlocal; ++i) {
    look_up(i, halves, row);
    now.add(row);
  }
  adopt(std::move(now), halves);
}

void BondMdanimHarmonic::take(SpringRows &&upper_rows)
{
  given = true;
  adopt(std::move(upper_rows), true);
}

void BondMdanimHarmonic::adopt(SpringRows &&now, bool halves)
{
  now.close();
  rows = std::move(now);
  upper_only = halves;
  made = ++versions;
  farthest = 0;
  for (int i = 0; halves && i < rows.size(); ++i)
    if (rows[i].size()) farthest = std::max(farthest, rows[i].first->offset);
}

void BondMdanimHarmonic::lost_partner(int i, int partner) const
{
  if (i < 0)
    error->one(FLERR,
               "bond_style mdanim/harmonic: bonds to particle {} were changed without a setup; leave out 'pre no' of this run, "
               "which is at step {}",
               partner, update->ntimestep);
  error->one(FLERR,
             "bond_style mdanim/harmonic: particle {} has lost its bond partner {} at step {}; if the "
             "bodies move as they should, raise the ghost cutoff ('comm_modify cutoff'); if they fly apart, "
             "lower the time step",
             atom->tag[i], partner, update->ntimestep);
}

// The bonds of particle i in the order in which their forces are summed: lower partners from the lowest tag up, which may be left
// out, then upper ones from the highest down.
void BondMdanimHarmonic::look_up(int i, bool halves, Row &row) const
{
  const bool periodic = domain->xperiodic || domain->yperiodic || domain->zperiodic;
  const tagint *const tag = atom->tag, own = tag[i];
  std::vector<SpringRows::Link> &link = row.link;
  link.clear();
  tagint before = 0;
  bool ascending = true;
  for (int b = 0; b < atom->num_bond[i]; ++b) {
    const tagint other = atom->bond_atom[i][b];
    const int type = atom->bond_type[i][b];
    if (type <= 0 || (halves && other < own)) continue;    // 0 and less: switched off by delete_bonds
    int partner = atom->map(other);
    if (partner < 0) lost_partner(i, other);
    if (periodic) partner = domain->closest_image(i, partner);
    link.push_back({partner - i, type});
    ascending = ascending && other > before;
    before = other;
  }
  const auto tag_of = [tag, i](const SpringRows::Link &l) { return tag[i + l.offset]; };
  if (!ascending) std::stable_sort(link.begin(), link.end(), [&](const auto &a, const auto &b) { return tag_of(a) < tag_of(b); });
  const auto upper = std::find_if(link.begin(), link.end(), [&](const auto &l) { return tag_of(l) > own; });
  row.lower = static_cast<int>(upper - link.begin());
  std::reverse(upper, link.end());
  for (auto several = link.begin(); several != upper;) {    // several bonds between the same two: in the same order at both ends
    const auto end = std::find_if(several, upper, [&](const auto &l) { return l.offset != several->offset; });
    std::reverse(several, end);
    several = end;
  }
}

bool BondMdanimHarmonic::has_dashpots() const
{
  return std::any_of(spring.begin(), spring.end(), [](const Spring &s) { return s.c > 0.0; });
}

// Makes coefficients of all types, and a new version where one differs from before. Without init_style() dashpots cannot begin:
// nothing has checked that ghosts have velocities, and their account has no forces to start from.
bool BondMdanimHarmonic::refresh_coefficients()
{
  if (!coefficients_may_differ) return false;
  if (!damped && has_dashpots())
    error->all(FLERR, "bond_style mdanim/harmonic: bond_coeff has given dashpots (c > 0) to springs that had none since the last "
                      "run; leave out 'pre no' of this run");
  coefficients_may_differ = false;
  std::vector<SpringCoeffs> now;
  for (const Spring &s : spring) now.emplace_back(s);
  if (now == law) return false;
  made = ++versions;
  law = std::move(now);
  return true;
}

// With particles in tag order and all partners here, the lower partners of a row come before it.
bool BondMdanimHarmonic::halves_suffice() const
{
  const int nlocal = atom->nlocal;
  if (!std::is_sorted(atom->tag, atom->tag + nlocal)) return false;
  Row row;
  for (int i = 0; atom->nghost && i < nlocal; ++i) {
    look_up(i, false, row);
    if (std::any_of(row.link.begin(), row.link.end(), [=](const auto &l) { return i + l.offset >= nlocal; })) return false;
  }
  return true;
}

bool BondMdanimHarmonic::halves(HalfBonds &half) const
{
  if (!upper_only || rows.size() != atom->nlocal) return false;
  half = {&rows, law.data()};
  return true;
}

// --- other functions that LAMMPS calls ---

double BondMdanimHarmonic::equilibrium_distance(int type) { return spring[type].r0; }

// Energy and -dU/dr / r of one bond, without its dashpot.
double BondMdanimHarmonic::single(int type, double rsq, int, int, double &fforce)
{
  const SpringCoeffs own(spring[type]);
  fforce = spring_factor(own.push, own.pull, rsq + R2_FLOOR);
  return mdanim::energy(spring[type], std::sqrt(rsq));
}

// Restart and data files hold only the bonds of particles.
void BondMdanimHarmonic::refuse_if_given()
{
  if (given)
    error->one(FLERR, "bond_style mdanim/harmonic: springs were given to it by mdanim_give_springs, and a file would be "
                      "without them; let the particles have their bonds themselves");
}

void BondMdanimHarmonic::write_restart(FILE *fp)
{
  refuse_if_given();
  fwrite(&RESTART_VERSION, sizeof RESTART_VERSION, 1, fp);
  fwrite(&spring[1], sizeof(Spring), atom->nbondtypes, fp);
}

void BondMdanimHarmonic::read_restart(FILE *fp)
{
  allocate();
  int version = 0;
  if (comm->me == 0) utils::sfread(FLERR, &version, sizeof version, 1, fp, nullptr, error);
  MPI_Bcast(&version, 1, MPI_INT, 0, world);
  if (version != RESTART_VERSION)
    error->all(FLERR,
               "bond_style mdanim/harmonic: the record of coefficients has version {}, {} is needed; write the restart file "
               "anew with this version of the plugin",
               version, RESTART_VERSION);
  if (comm->me == 0) utils::sfread(FLERR, &spring[1], sizeof(Spring), atom->nbondtypes, fp, nullptr, error);
  MPI_Bcast(&spring[1], atom->nbondtypes * static_cast<int>(sizeof(Spring)), MPI_BYTE, 0, world);
  std::fill(setflag + 1, setflag + atom->nbondtypes + 1, 1);
}

void BondMdanimHarmonic::write_data(FILE *fp)
{
  refuse_if_given();
  for (int type = 1; type <= atom->nbondtypes; ++type) {
    fprintf(fp, "%d %.17g %.17g", type, spring[type].K, spring[type].r0);
    fprintf(fp, spring[type].c > 0.0 ? " %.17g\n" : "\n", spring[type].c);
  }
}

double BondMdanimHarmonic::memory_usage()
{
  const auto ints = source.tag.capacity() + source.count.capacity();
  return Bond::memory_usage() + rows.bytes() + loss.bytes() + ints * sizeof(int) + law.capacity() * sizeof(SpringCoeffs);
}

// For atoms_c.cpp: "seconds" and "lost" of this rank.
void *BondMdanimHarmonic::extract(const char *what, int &dim)
{
  dim = 0;
  if (strcmp(what, "seconds") == 0) return &seconds;
  if (strcmp(what, "lost") == 0) {
    lost = loss.total();
    return &lost;
  }
  return nullptr;
}
