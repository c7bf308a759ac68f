// SPDX-License-Identifier: GPL-2.0-only
// run_style verlet/mdanim. A step of LAMMPS begins with a half kick and a drift and finishes with forces and the other half kick.
// Between two outputs a pass finishes a step and begins the next at once, in arrays of its own (passes/pass_engine.h); with a fix
// that is not a PassMember each step is that of run_style verlet. The bits are the same. With other ranks, ghosts are lanes that
// do not move: they get their positions and, for dashpots, velocities before every pass, and what springs do to them is thrown
// away. Ranks decide together.

#include "lammps/verlet_mdanim.h"

#include "lammps/mpi_wait.h"

#include "angle.h"
#include "atom.h"
#include "bond.h"
#include "comm.h"
#include "compute.h"
#include "dihedral.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "fmt/format.h"
#include "force.h"
#include "improper.h"
#include "kspace.h"
#include "modify.h"
#include "neighbor.h"
#include "output.h"
#include "pair.h"
#include "timer.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <limits>

using namespace LAMMPS_NS;
using namespace mdanim;

// run_style verlet/mdanim [width common|avx2|avx512] [threads N]
VerletMdanim::VerletMdanim(LAMMPS *lmp, int narg, char **arg) : SplitVerlet(lmp, 0, arg), search(lmp)
{
  if (const char *width = std::getenv("MDANIM_WIDTH"); width && *width) set_width(width);
  for (int n = 0; n < narg; n += 2) {
    if (strcmp(arg[n], "width") != 0 && strcmp(arg[n], "threads") != 0)
      error->all(FLERR, "run_style verlet/mdanim: unknown keyword {}; it knows width and threads", arg[n]);
    if (n + 1 == narg)
      error->all(FLERR, "run_style verlet/mdanim: {}",
                 strcmp(arg[n], "width") == 0 ? "width takes one word, common, avx2 or avx512"
                                              : "threads takes a number, e.g. threads 4");
    if (strcmp(arg[n], "width") == 0)
      set_width(arg[n + 1]);
    else
      set_threads(arg[n + 1]);
  }
}

void VerletMdanim::set_threads(const char *word)
{
  const int threads = utils::inumeric(FLERR, word, false, lmp);
  if (threads < 1 || threads > MOST_THREADS)
    error->all(FLERR, "run_style verlet/mdanim: threads is a number from 1 to {}, not {}", MOST_THREADS, threads);
  engine.set_threads(Threads::of_run(threads));
}

void VerletMdanim::set_width(const char *word)
{
  told = kernels_named(word);
  int here = told != nullptr, everywhere = 0;    // hosts may have different processors
  MPI_Allreduce(&here, &everywhere, 1, MPI_INT, MPI_MIN, world);
  if (!everywhere)
    error->all(
        FLERR,
        "run_style verlet/mdanim: width {} is unknown or {} does not have it; leave width out, and every rank takes its best",
        word, comm->nprocs > 1 ? "the processor of some rank" : "this processor");
}

double VerletMdanim::memory_usage()
{ return static_cast<double>(engine.bytes() + ghosts.bytes() + sent.capacity() * sizeof(int)); }

// --- LAMMPS's list of bonds ---

void VerletMdanim::setup(int flag)
{
  begin_setup();
  Verlet::setup(flag);
}

void VerletMdanim::setup_minimal(int flag)
{
  begin_setup();
  Verlet::setup_minimal(flag);
}

// Called when lists are about to be made for the first time after init().
void VerletMdanim::begin_setup()
{
  decided_for = local_then = -1;
  search.forget_told();
  engine.drop();    // a run that an error has broken off, which a program has caught
  engine.forget_springs();
  budget.forget();
  spare_bond_list();
}

// Does without neighbor->bondlist where it is not needed: it takes 100 bytes per particle of a lattice and longer to make than
// many steps, and our bond style reads springs from their particles. Of fixes and computes only those known to ignore the list do
// not need it. It comes back with the next init().
void VerletMdanim::spare_bond_list()
{
  if (!dynamic_cast<PassSprings *>(force->bond) || force->pair || force->angle || force->dihedral || force->improper) return;
  const auto leaves_it = [](const char *style) {
    static constexpr const char *KNOWN[] = {"property/atom", "balance", "temp", "pressure", "pe", "ke"};
    return strncmp(style, "mdanim/", 7) == 0 ||
           std::any_of(std::begin(KNOWN), std::end(KNOWN), [style](const char *other) { return strcmp(style, other) == 0; });
  };
  const auto &fixes = modify->get_fix_list();
  const auto &computes = modify->get_compute_list();
  if (std::all_of(fixes.begin(), fixes.end(), [&](const Fix *fix) { return leaves_it(fix->style); }) &&
      std::all_of(computes.begin(), computes.end(), [&](const Compute *compute) { return leaves_it(compute->style); }))
    neighbor->set_overlap_topo(1);    // made where build_topology() is called
}

// --- whether passes can be taken ---

bool VerletMdanim::find_crew()
{
  PassCrew &crew = engine.crew;
  if (!search.find(crew)) return false;
  if (crew.liquid && !crew.liquid->joins(*crew.integrator)) crew.liquid = nullptr;
  if (crew.springs->refresh_coefficients()) decided_for = -1;
  if (engine.begin_run(told ? *told : widest_kernels())) decided_for = -1;
  return true;
}

// Cuts blocks for the springs as they are now, if passes are worth it.
bool VerletMdanim::cut()
{
  if (comm->nprocs > 1) return cut_for_ranks();
  return atom->nghost == 0 && engine.cut(atom->nlocal, atom->molecule_flag ? atom->molecule : nullptr);
}

// The same, once after every rebuild. All ranks take passes or none: a rank with few particles or none has little weight.
bool VerletMdanim::cut_for_ranks()
{
  if (decided_for == neighbor->ncalls) return worth_it;
  decided_for = neighbor->ncalls;
  const std::vector<PassIntegrator::Known> known = engine.crew.integrator->survey_ghosts(sent);
  std::vector<int> object;
  for (const auto &one : known) object.push_back(one.object);
  const LaneUse here = engine.cut({atom->nlocal, atom->tag, object.data(), atom->num_bond, atom->bond_type, atom->bond_atom,
                                   [this](int partner) { return atom->map(partner); },
                                   [this](int i, int partner) { engine.crew.springs->lost_partner(i, partner); }});
  double all[] = {here.springs, here.lanes};
  MPI_Allreduce(MPI_IN_PLACE, all, 2, MPI_DOUBLE, MPI_SUM, world);
  worth_it = LaneUse{all[0], all[1]}.worth_it();
  std::vector<Home> home;
  for (const int i : engine.order().places())
    if (i >= atom->nlocal) home.push_back(known[i].home);
  if (worth_it) ghosts.survey(world, home, engine.laid_out());
  return worth_it;
}

// --- the run ---

void VerletMdanim::run(int n)
{
  refuse_if_moved();
  if (find_crew()) {
    run_passes(n);
  } else {
    search.tell_why(n);
    equip_members();
    Verlet::run(n);
  }
  local_then = atom->nlocal;
  ghosts_then = atom->nghost;
}

// In LAMMPS's own steps, too, springs and contacts are computed by kernels and threads.
void VerletMdanim::equip_members() const
{
  const Kernels &kernels = told ? *told : widest_kernels();
  const auto equip = [&](auto *style) {
    if (auto *member = dynamic_cast<Equipped *>(style)) engine.equip(*member, kernels);
  };
  equip(force->bond);
  for (Fix *fix : modify->get_fix_list()) equip(fix);
}

void VerletMdanim::run_passes(int n)
{
  overflowed = false;
  if (comm->nprocs > 1) {
    budget.set_ranks([this](double *numbers, int count) {
      MPI_Request request;
      MPI_Iallreduce(MPI_IN_PLACE, numbers, count, MPI_DOUBLE, MPI_MIN, world, &request);
      wait_for(1, &request);
    });
  } else {
    budget.set_alone();
  }
  for (int i = 0; i < n; ++i) {
    if (timer->check_timeout(i)) {
      update->nsteps = i;
      break;
    }
    begin_step();
    if (!overflowed && cut())
      i += take_steps(i, n - 1 - i);
    else if (i == 0) {
      if (!overflowed) search.find_why_not_cut(*engine.crew.springs);
      search.tell_why(n);
    }
    finish_step();
  }
}

// LAMMPS itself requires a setup here, but does not notice when it is left out.
void VerletMdanim::refuse_if_moved()
{
  int moved = local_then >= 0 && (atom->nlocal != local_then || atom->nghost != ghosts_then), anywhere = 0;
  MPI_Allreduce(&moved, &anywhere, 1, MPI_INT, MPI_MAX, world);
  if (anywhere)
    error->all(FLERR, "run_style verlet/mdanim: particles were added, deleted or given to other ranks since the last run; "
                      "leave out 'pre no' of this one");
}

// The step at which an output or a fix needs LAMMPS's arrays.
bigint VerletMdanim::next_stop() const
{
  bigint stop = output->next;
  for (int n = 0; n < modify->nfix; ++n) {
    const Fix *fix = modify->fix[n];
    if (fix->force_reneighbor && fix->next_reneighbor >= update->ntimestep) stop = std::min(stop, fix->next_reneighbor);
  }
  return stop;
}

AtomArrays VerletMdanim::arrays() const { return {atom->x, atom->v, atom->f}; }

// Up to `most` times: finishes the step that has begun and begins the next. Returns how often.
int VerletMdanim::take_steps(int step, int most)
{
  const bigint stop = std::min(next_stop(), update->ntimestep + most);
  if (update->ntimestep >= stop) return 0;
  const bool in_range = PassRun::in_range(arrays(), atom->nlocal);
  if (search.lists_matter()) {
    tell_limits();
    measure();
    if (!spend(in_range ? 0.0 : DisplacementBudget::OVERFLOW)) return 0;
    budget.begin(neighbor->ncalls);
  } else if (!in_range) {
    overflowed = true;
    return 0;
  }

  timer->stamp();
  if (comm->nprocs > 1) comm->forward_comm();
  start_passes(true);
  int taken = 0;
  while (update->ntimestep < stop) {
    if (comm->nprocs > 1 && !ghosts_are_met) meet_ghosts();
    ghosts_are_met = false;
    PassRun &passes = engine.running();
    passes.step(update->ntimestep + 1, [this](bool at_end) { act_late(at_end); });
    ++taken;
    ++passed;
    ++update->ntimestep;
    ++neighbor->ago;
    if (timer->check_timeout(step + taken)) break;
    const bool finite = passes.in_range();
    if (search.lists_matter() ? spend(finite ? update->dt * passes.largest_speed() : DisplacementBudget::OVERFLOW) : finite)
      continue;
    overflowed = overflowed || !finite;
    if (overflowed || update->ntimestep >= stop || !look_again()) break;
  }
  if (engine.is_running()) leave_passes();
  timer->stamp(Timer::BOND);
  ev_set(update->ntimestep);
  return taken;
}

// Forces of fixes that come after the pass, or their work at the end of the step.
void VerletMdanim::act_late(bool at_end)
{
  for (const CrewSearch::Late &one : search.late()) {
    if (!at_end) one.fix->post_force(vflag);
    if (at_end && one.acts_at_end) one.fix->end_of_step();
  }
}

void VerletMdanim::start_passes(bool positions)
{
  ghosts_are_met = true;
  participants_look = engine.start(arrays(), update->dt, positions, neighbor->ncalls).participants_look();
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, &participants_look, 1, MPI_INT, MPI_MAX, world);
}

// Half the skin, and farther if no participant needs lists until then: the springs' partners stay the same.
void VerletMdanim::tell_limits()
{
  constexpr double ANY = std::numeric_limits<double>::max();
  constexpr int SHRINK = 2;    // LAMMPS's number for a boundary that goes where particles are
  if (comm->nprocs > 1) {
    std::array<BoxShare, 3> shares;
    for (int d = 0; d < 3; ++d)
      shares[d] = {domain->boxlo[d],
                   domain->boxhi[d],
                   domain->sublo[d],
                   domain->subhi[d],
                   domain->boundary[d][0] == SHRINK,
                   domain->boundary[d][1] == SHRINK};
    budget.set_shares(shares);
  }
  budget.set_limits(0.5 * neighbor->skin,
                    search.strangers_have_lists() ? SafeDisplacement{0.0, 0.0} : engine.crew.safe_displacement(ANY));
}

// Measures the budget that is left, with particles as they stand in the blocks or else in LAMMPS.
void VerletMdanim::measure()
{
  if (engine.is_running())
    budget.measure(atom->nlocal, [&blocks = engine.laid_out()](int i) { return blocks.where(i); }, neighbor->get_xhold());
  else
    budget.measure(atom->nlocal, [this](int i) { return vec3(atom->x[i]); }, neighbor->get_xhold());
}

// Whether some of the budget is left on all ranks.
bool VerletMdanim::spend(double way)
{
  const bool some = budget.spend(way);
  overflowed = overflowed || budget.overflowed();
  return some;
}

// Between two passes: measures how far particles really are, and makes lists anew if necessary. False where passes do not go on.
bool VerletMdanim::look_again()
{
  timer->stamp(Timer::BOND);
  measure();
  // Strain rates do not migrate with springs: several ranks make lists in a plain step, when they are due.
  const bool alone = comm->nprocs == 1, between_passes = alone || !engine.crew.springs->account();
  if (spend(0.0) && !(between_passes && budget.nearly_spent())) return true;
  leave_passes();
  if (!between_passes) return false;
  const bool same_places = rebuild_lists();
  if (alone ? !same_places : !cut()) return false;
  if (alone && search.late().empty()) engine.keep_motion(neighbor->ncalls);    // no fix has changed how particles move
  tell_limits();
  if (alone)
    budget.measure_unmoved();
  else
    measure();
  spend(0.0);
  budget.begin(neighbor->ncalls);
  // On a rank that is alone, particles are mostly where they were.
  start_passes(!alone || modify->n_pre_exchange || modify->n_pre_neighbor);
  return true;
}

// Dashpots tell their forces by the present places and velocities of both particles, so ghosts are met once more.
void VerletMdanim::leave_passes()
{
  if (comm->nprocs > 1 && !ghosts_are_met && engine.crew.springs->account()) meet_ghosts();
  engine.leave();
}

// Updates ghosts on all ranks. Participants look for particles in the arrays of LAMMPS.
void VerletMdanim::meet_ghosts()
{
  timer->stamp(Timer::BOND);
  SimdBlocks &blocks = engine.laid_out();
  if (participants_look) {
    blocks.give_out_places(sent, atom->x, comm->ghost_velocity ? atom->v : nullptr);
    comm->forward_comm();
    blocks.take_in_ghosts(atom->x, atom->v);
  } else {
    ghosts.meet(world, blocks, comm->ghost_velocity);
  }
  timer->stamp(Timer::COMM);
}

// As LAMMPS decides it, but later if no participant needs lists now; a file gets the present box.
bool VerletMdanim::lists_are_due()
{
  const bigint now = update->ntimestep;
  if (neighbor->ago == 0 && neighbor->lastcall == now) return false;    // look_again() has made them; `ago` still says so
  if (neighbor->build_once || !neighbor->dist_check || now == output->next_dump_any || now == output->next_restart)
    return neighbor->decide();
  for (const Fix *fix : modify->get_fix_list())
    if (fix->force_reneighbor && fix->next_reneighbor == now) return true;
  tell_limits();
  if (budget.farthest() <= 0.5 * neighbor->skin) return neighbor->decide();
  ++neighbor->ago;
  measure();
  return !spend(0.0);
}
