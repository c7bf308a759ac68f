// SPDX-License-Identifier: GPL-2.0-only
// Conditions for passes, each with the reason to write where it does not hold.

#include "lammps/crew_search.h"

#include "atom.h"
#include "bond.h"
#include "comm.h"
#include "domain.h"
#include "fix.h"
#include "fmt/format.h"
#include "force.h"
#include "lammps.h"
#include "modify.h"
#include "neighbor.h"
#include "pair.h"
#include "utils.h"

#include <cstring>

using namespace LAMMPS_NS;

namespace mdanim {

// Actions of a fix in a step that passes must know of.
static constexpr int ACTS = FixConst::INITIAL_INTEGRATE | FixConst::POST_INTEGRATE | FixConst::PRE_FORCE | FixConst::PRE_REVERSE |
                            FixConst::POST_FORCE | FixConst::FINAL_INTEGRATE | FixConst::END_OF_STEP;

// Keeps the reason for plain steps and the text to write, "" where the user can do nothing about it.
bool CrewSearch::plain(const std::string &reason)
{
  why = reason;
  return false;
}

void CrewSearch::tell_why(int steps)
{
  if (steps < 2 || why.empty() || why == told_why) return;
  told_why = why;
  if (comm->me == 0)
    utils::logmesg(lmp, "run_style verlet/mdanim: no passes, every step is that of run_style verlet, as {}\n", why);
}

bool CrewSearch::find(PassCrew &crew)
{
  crew = {};
  found_late.clear();
  strangers_read_lists = neighbor->nlist > 0;
  why.clear();
  auto *springs = dynamic_cast<PassSprings *>(force->bond);
  if (!springs || !springs->join(crew)) {
    const std::string style = force->bond ? force->bond_style : "none";
    return plain(style == "none" || style == "zero" ? "" : "bond_style is " + style + "; use mdanim/harmonic");
  }
  if (domain->triclinic || domain->dimension != 3)
    return plain("the box is triclinic or has 2 dimensions; use an orthogonal one of 3");
  if (force->pair && force->pair->compute_flag)
    return plain(fmt::format("pair_style {} computes forces; use 'pair_style none' or zero", force->pair_style));
  if (force->angle || force->dihedral || force->improper || force->kspace)
    return plain("an angle, dihedral, improper or kspace style computes forces; use 'none'");
  for (int n = 0; n < modify->nfix; ++n) {
    Fix *fix = modify->fix[n];
    const int mask = modify->fmask[n];
    if (auto *member = dynamic_cast<PassMember *>(fix)) {
      if (!member->join(crew))
        return plain(fmt::format("fix {} {} is the second of its kind, or comes after fixes that it must precede; use one fix "
                                 "mdanim/leapfrog, and one fix mdanim/gravity before all others",
                                 fix->id, fix->style));
      if (crew.late.size() > found_late.size()) found_late.push_back({fix, (mask & FixConst::END_OF_STEP) != 0});
    } else if (mask & ACTS) {
      const char *const ours = utils::strmatch(fix->style, "^nve")  ? "; use mdanim/leapfrog"
                               : strcmp(fix->style, "gravity") == 0 ? "; use mdanim/gravity"
                               : strcmp(fix->style, "OMP") == 0     ? "; leave out '-sf omp' and 'package omp'"
                                                                    : "; leave it out if it can be done without";
      return plain(fmt::format("fix {} {} acts in every step{}", fix->id, fix->style, ours));
    } else if (mask & FixConst::POST_NEIGHBOR) {
      strangers_read_lists = true;
    }
  }
  const bool periodic = domain->xperiodic || domain->yperiodic || domain->zperiodic;
  // Blocks do not have images, and with several ranks no particle may go beyond the neighbours of its own unseen.
  if (periodic) return plain("the box is periodic; use 'boundary s s s' (or f)");
  if (comm->nprocs > 1 && neighbor->build_once) return plain("lists are never rebuilt; use 'neigh_modify once no'");
  lists_are_read = !neighbor->build_once && (modify->n_post_neighbor || modify->n_pre_neighbor || comm->nprocs > 1);
  if (!crew.integrator) return plain("there is no fix mdanim/leapfrog; it moves particles in passes");
  // Without that check LAMMPS does not keep former places of particles, or not all of them.
  if (lists_are_read && !neighbor->dist_check)
    return plain("nothing checks how far particles move; use 'neigh_modify check yes'");
  if (lists_are_read && neighbor->includegroup) return plain("lists are of one group alone; use 'neigh_modify include all'");
  return true;
}

// Few particles gain nothing. Springs that a program has given are numbered by that program.
void CrewSearch::find_why_not_cut(const PassSprings &springs)
{
  constexpr bigint FEW = 1000;
  HalfBonds half;
  why.clear();
  if (comm->nprocs == 1 && !springs.halves(half))
    why = "particles do not stand in the order of their IDs; use 'atom_modify sort 0 0' before the box is made, and write them "
          "in that order";
  else if (atom->natoms >= FEW && atom->nbonds > 0)
    why = "springs of particles with neighbouring IDs lead unequally far; number the particles of a lattice row by row";
}

}    // namespace mdanim
