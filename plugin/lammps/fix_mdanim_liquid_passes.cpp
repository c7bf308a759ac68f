// SPDX-License-Identifier: GPL-2.0-only
// The liquid's part in passes of run_style verlet/mdanim.

#include "lammps/fix_mdanim_liquid.h"

#include "numbers/vec3.h"

#include "atom.h"
#include "error.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace mdanim;

// Settings that only steps read may change without a setup; those of solids may not.
void FixMdanimLiquid::need_setup() const
{
  if (changed_since_setup)
    error->all(FLERR, "{}: fix_modify has changed what the setup of a run reads; leave out 'pre no' of this run", name());
}

void FixMdanimLiquid::append_required_atoms(std::vector<int> &particles) const
{
  if (!in_passes) particles.insert(particles.end(), near.begin(), near.end());
}

bool FixMdanimLiquid::join(PassCrew &crew)
{
  need_setup();
  in_passes = false;
  if (!crew.liquid) crew.liquid = this;
  return PassParticipant::join(crew);
}

bool FixMdanimLiquid::joins(const double *lambda) { return in_passes = buoyancy->acts_in_passes(*basin, lambda); }

InLiquid *FixMdanimLiquid::kept() { return buoyancy->kept.data(); }

// When this is called, the arrays hold the last places of all particles.
void FixMdanimLiquid::split(const std::vector<int> *in_arrays)
{
  is_split = in_arrays;
  if (!is_split) return;
  near_in_arrays.clear();
  for (const int i : *in_arrays)
    if (is_near(i)) near_in_arrays.push_back(i);
  fastest_in_passes = fastest_in_arrays(near);
}

void FixMdanimLiquid::acted(double work, double lost, double fastest, double seconds)
{
  buoyancy->add_power({work, lost}, seconds);
  fastest_in_passes = fastest;
}

// An update needs all bodies. With passes that act in the liquid it comes before them.
bool FixMdanimLiquid::needs_all_atoms() { return !in_passes && is_due(); }

// While the liquid is level and no particle is near it: the way until one comes near.
double FixMdanimLiquid::safe_displacement() const
{ return lists_are_prompt() && asleep() ? lowest - (listed_top + Basin::NEAR * basin->shape.cell.z) : 0.0; }

// Square of the speed of the fastest of these; -1 without any.
double FixMdanimLiquid::fastest_in_arrays(const std::vector<int> &these) const
{
  double fastest = -1.0;
  const double *const *x = atom->x, *const *v = atom->v;
  const double below = top_of_near();
  for (const int i : these)
    if (x[i][2] < below) fastest = std::max(fastest, dot(vec3(v[i]), vec3(v[i])));
  return fastest;
}

double FixMdanimLiquid::top_of_near() const { return top_height(basin->top() + Basin::NEAR); }
