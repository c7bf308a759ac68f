// SPDX-License-Identifier: GPL-2.0-only
// compute mdanim/timestep. Each particle has a block D = sum of k n n^T over its springs, in their present places. All springs
// together are at most twice the blocks, and a wall does not move, so dt^2 (2 |D| + k_wall) / m + 4 dt |D'| / m <= 4 is
// sufficient, with the same block D' of dashpots (docs/physics-solids.md).

#include "lammps/compute_mdanim_timestep.h"

#include "lammps/bond_mdanim_harmonic.h"
#include "lammps/fix_mdanim_wall.h"
#include "lammps/particle_value.h"
#include "springs/stable_step.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <string>

using namespace LAMMPS_NS;
using namespace mdanim;

ComputeMdanimTimestep::ComputeMdanimTimestep(LAMMPS *lmp, int narg, char **arg) : Compute(lmp, narg, arg)
{
  if (narg > 3) error->all(FLERR, 3, "compute mdanim/timestep takes no arguments, got {}", arg[3]);
  scalar_flag = vector_flag = 1;
  size_vector = 4;
  extscalar = extvector = 0;
  vector = new double[size_vector];
}

ComputeMdanimTimestep::~ComputeMdanimTimestep() { delete[] vector; }

static bool is_any_of(const std::string &style, std::initializer_list<const char *> names)
{
  return std::any_of(names.begin(), names.end(), [&](const char *name) { return style == name; });
}

// Null for none. Like walls(), looked up whenever it is needed: LAMMPS calls this between two runs as well, when any may have
// been deleted.
const BondMdanimHarmonic *ComputeMdanimTimestep::springs() const
{
  const auto *bonds = dynamic_cast<const BondMdanimHarmonic *>(force->bond);
  if (force->bond && !bonds && !is_any_of(force->bond_style, {"none", "zero"}))
    error->all(FLERR, "compute {} mdanim/timestep: knows the springs of bond_style mdanim/harmonic only, not of {}", id,
               force->bond_style);
  if (bonds && bonds->are_given())
    error->all(FLERR, "compute {} mdanim/timestep: springs were given by a program, and particles have no bonds to look at", id);
  for (int type = 1; bonds && type <= atom->nbondtypes; ++type)
    if (!bonds->setflag || !bonds->setflag[type])
      error->all(FLERR, "compute {} mdanim/timestep: bond type {} has no coefficients yet; use bond_coeff", id, type);
  return bonds;
}

std::vector<FixMdanimWall *> ComputeMdanimTimestep::walls() const
{
  std::vector<FixMdanimWall *> found;
  for (Fix *fix : modify->get_fix_list())
    if (auto *wall = dynamic_cast<FixMdanimWall *>(fix)) found.push_back(wall);
  return found;
}

void ComputeMdanimTimestep::init()
{
  springs();
  std::string others;
  const auto name = [&others](const std::string &other) { others += (others.empty() ? "" : ", ") + other; };
  for (Fix *fix : modify->get_fix_list()) {
    if (is_any_of(fix->style, {"mdanim/barrier", "mdanim/contact", "mdanim/liquid"}))
      name(std::string("fix ") + fix->id + " " + fix->style);
  }
  if (force->pair && !is_any_of(force->pair_style, {"none", "zero"})) name(std::string("pair_style ") + force->pair_style);
  if (!others.empty() && comm->me == 0)
    error->warning(FLERR,
                   "compute {} mdanim/timestep: the bound is of springs, dashpots and walls; not in it: {}. Take half of it", id,
                   others);
}

double ComputeMdanimTimestep::compute_scalar()
{
  if (invoked_vector != update->ntimestep) compute_vector();
  invoked_scalar = update->ntimestep;
  return scalar = vector[2];
}

void ComputeMdanimTimestep::compute_vector()
{
  invoked_vector = update->ntimestep;
  const bool periodic = domain->xperiodic || domain->yperiodic || domain->zperiodic;
  const auto place = [this](int i) { return vec3(atom->x[i]); };
  struct OfWall {
    int groupbit;
    const double *values;    // nullptr: all have the same
    double number;
  };
  std::vector<OfWall> push;
  const BondMdanimHarmonic *const bonds = springs();
  for (FixMdanimWall *wall : walls()) push.push_back({wall->groupbit, wall->stiffness_values(), wall->stiffness_number()});

  const double infinite = stable_step(0.0, 0.0);
  std::array<double, 3> least = {infinite, infinite, infinite};    // with springs; with dashpots as well; with walls as well
  tagint worst = 0;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    SymmetricBlock stiff, damp;
    for (int b = 0; bonds && b < atom->num_bond[i]; ++b) {
      const int type = atom->bond_type[i][b];
      if (type <= 0) continue;    // switched off by delete_bonds
      int partner = atom->map(atom->bond_atom[i][b]);
      if (partner < 0) bonds->lost_partner(i, static_cast<int>(atom->bond_atom[i][b]));
      if (periodic) partner = domain->closest_image(i, partner);
      const Vec3 d = place(i) - place(partner);
      const double r = std::sqrt(dot(d, d));
      if (r == 0.0) continue;    // has neither direction nor force
      const Spring &spring = bonds->springs()[type];
      stiff.add(2.0 * spring.K, (1.0 / r) * d);
      damp.add(spring.c, (1.0 / r) * d);
    }
    double of_walls = 0.0;
    for (const OfWall &wall : push)
      if (atom->mask[i] & wall.groupbit) of_walls += wall.values ? wall.values[i] : wall.number;
    const double per_mass = force->ftm2v / mass_of(atom->rmass, atom->mass, atom->type, i);
    const double a = 2.0 * stiff.largest_eigenvalue() * per_mass, b = 2.0 * damp.largest_eigenvalue() * per_mass;
    least[0] = std::min(least[0], stable_step(a, 0.0));
    least[1] = std::min(least[1], stable_step(a, b));
    if (const double all = stable_step(a + of_walls * per_mass, b); all < least[2]) {
      least[2] = all;
      worst = atom->tag[i];
    }
  }
  MPI_Allreduce(least.data(), vector, 3, MPI_DOUBLE, MPI_MIN, world);
  // The lowest tag of several particles that set it, on whichever rank.
  const tagint none = MAXTAGINT, own = worst && least[2] == vector[2] ? worst : none;
  tagint first;
  MPI_Allreduce(&own, &first, 1, MPI_LMP_TAGINT, MPI_MIN, world);
  vector[3] = first == none ? 0.0 : static_cast<double>(first);
}
