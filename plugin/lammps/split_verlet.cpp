// SPDX-License-Identifier: GPL-2.0-only
// The work of Verlet::run() of LAMMPS in a step, for fixes and outputs that passes allow.

#include "lammps/split_verlet.h"

#include "atom.h"
#include "bond.h"
#include "comm.h"
#include "domain.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"
#include "output.h"
#include "timer.h"
#include "update.h"

using namespace LAMMPS_NS;

void SplitVerlet::begin_step()
{
  ev_set(++update->ntimestep);
  timer->stamp();
  modify->initial_integrate(vflag);
  timer->stamp(Timer::MODIFY);
}

void SplitVerlet::finish_step()
{
  if (lists_are_due()) {
    rebuild_lists();
  } else {
    timer->stamp();
    comm->forward_comm();
    timer->stamp(Timer::COMM);
  }
  force_clear();
  timer->stamp();
  force->bond->compute(eflag, vflag);
  timer->stamp(Timer::BOND);
  if (modify->n_post_force_any) modify->post_force(vflag);
  modify->final_integrate();
  if (modify->n_end_of_step) modify->end_of_step();
  timer->stamp(Timer::MODIFY);
  if (update->ntimestep == output->next) {
    timer->stamp();
    output->write(update->ntimestep);
    timer->stamp(Timer::OUTPUT);
  }
}

bool SplitVerlet::rebuild_lists()
{
  timer->stamp();
  if (modify->n_pre_exchange) modify->pre_exchange();
  timer->stamp(Timer::MODIFY);
  domain->pbc();
  if (domain->box_change) {
    domain->reset_box();
    comm->setup();
    if (neighbor->style) neighbor->setup_bins();
  }
  timer->stamp();
  const int before = atom->nlocal;
  const bool sorted = atom->sortfreq > 0 && update->ntimestep >= atom->nextsort;
  comm->exchange();
  if (sorted) atom->sort();
  comm->borders();
  timer->stamp(Timer::COMM);
  if (modify->n_pre_neighbor) modify->pre_neighbor();
  timer->stamp(Timer::MODIFY);
  // LAMMPS's own list of bonds takes longer to make than a step; it holds as long as particles stay in their places.
  const bool same =
      comm->nprocs == 1 && !sorted && atom->nghost == 0 && atom->nlocal == before && modify->get_fix_by_style("^bond/").empty();
  neighbor->build(same ? 0 : 1);
  timer->stamp(Timer::NEIGH);
  if (modify->n_post_neighbor) modify->post_neighbor();
  timer->stamp(Timer::MODIFY);
  return same;
}
