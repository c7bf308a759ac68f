// SPDX-License-Identifier: GPL-2.0-only
// bond_style mdanim/harmonic. Every particle sums its own bonds in an order given by its partners' tags, lower tags from the
// lowest up, higher ones from the highest down, and adds the two sums to its force once. So the bits of a force depend on neither
// the order of particles nor the ranks that hold them.

#include "lammps/bond_mdanim_harmonic.h"
#include "lammps/keywords.h"

#include "numbers/stopwatch.h"
#include "simd/kernels.h"
#include "springs/row_forces.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <utility>

using namespace LAMMPS_NS;
using namespace mdanim;

static constexpr int RESTART_VERSION = 1;

static bigint versions = 0;    // shared by the springs of all instances

BondMdanimHarmonic::BondMdanimHarmonic(LAMMPS *lmp) : Bond(lmp), rows(lmp) {}

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

// --- springs ---

void BondMdanimHarmonic::take(SpringRows &&upper_rows)
{
  rows.take(std::move(upper_rows));
  made = ++versions;
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

bool BondMdanimHarmonic::halves(HalfBonds &half) const
{
  if (!rows.are_halves() || rows.all().size() != atom->nlocal) return false;
  half = {&rows.all(), law.data()};
  return true;
}

// --- forces ---

void BondMdanimHarmonic::compute(int eflag, int vflag)
{
  const Lap lap(seconds);
  ev_init(eflag, vflag);
  const bool other_lists = neighbor->ago == 0 || made_after != neighbor->ncalls;    // made in this step, or between two passes
  made_after = neighbor->ncalls;
  if ((other_lists || bonds_are_changed) && rows.update_rows(update->setupflag || bonds_are_swapped || bonds_are_changed))
    made = ++versions;
  bonds_are_changed = false;
  refresh_coefficients();

  std::vector<Vec3> *dashpots = nullptr;
  if (damped) {
    if (other_lists) loss.look(atom->tag, atom->nlocal);
    dashpots = &loss.forces(atom->nlocal);
  }
  if (rows.all().size() > 0)
    energy += add_row_forces({rows.all(), rows.are_halves(), rows.farthest(), spring, law}, {atom->x[0], atom->v[0], atom->f[0]},
                             eflag_global, dashpots, threads, widest_kernels().springs);
  if (dashpots) loss.step(atom->v, update->dt, update->setupflag);
  if (eflag_atom || vflag_either) tally();
}

template <class Visit> void BondMdanimHarmonic::each_spring(Visit visit) const
{
  const double *x = atom->x[0];
  for (int i = 0; i < atom->nlocal; ++i) {
    const Vec3 here = vec3(x + 3 * i);
    for (const SpringRows::Link &link : rows.all()[i])
      visit(i, i + link.offset, link.type, here - vec3(x + 3 * (i + link.offset)));
  }
}

// Virial and energy of each particle in steps that need them. Half of a bond's share goes to either end, which tallies it in its
// own row where rows are whole.
void BondMdanimHarmonic::tally()
{
  const double share = rows.are_halves() ? 1.0 : 0.5;
  double sums[6] = {};
  each_spring([&](int i, int j, int type, const Vec3 &d) {
    const double r2 = dot(d, d);
    if (eflag_atom) {
      const double e = mdanim::energy(spring[type], std::sqrt(r2));
      eatom[i] += 0.5 * e;
      if (rows.are_halves()) eatom[j] += 0.5 * e;
    }
    if (!vflag_either) return;
    const SpringCoeffs &own = law[type];
    const double square = floored_square(d);
    double factor = spring_factor(own.push, own.pull, square);
    if (own.c > 0.0) factor -= own.c * strain_rate(d, vec3(atom->v[i]) - vec3(atom->v[j]), square);
    const double w[6] = {d.x * d.x * factor, d.y * d.y * factor, d.z * d.z * factor,
                         d.x * d.y * factor, d.x * d.z * factor, d.y * d.z * factor};
    for (int k = 0; k < 6; ++k) sums[k] += share * w[k];
    if (!vflag_atom) return;
    for (int k = 0; k < 6; ++k) {
      vatom[i][k] += 0.5 * w[k];
      if (rows.are_halves()) vatom[j][k] += 0.5 * w[k];
    }
  });
  if (vflag_global) std::copy(sums, sums + 6, virial);
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
  if (rows.are_given())
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
{ return Bond::memory_usage() + static_cast<double>(rows.bytes() + loss.bytes() + law.capacity() * sizeof(SpringCoeffs)); }
