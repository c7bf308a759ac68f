// SPDX-License-Identifier: GPL-2.0-only
// run_style verlet/mdanim. A step of LAMMPS begins with a half kick and a drift and finishes with forces and the other half kick.
// Between two outputs our pass finishes a step and begins the next at once, in arrays of its own; whoever is not known to live with that (other
// fixes) gets run_style verlet as it is. The bits are the same. With other ranks, ghosts are lanes that do not move:
// they get their places and, for dashpots, velocities before every pass, and what springs do to them is thrown away. Ranks decide together.

#include "verlet_mdanim.h"

#include "bond_mdanim_harmonic.h"
#include "fix_mdanim_gravity.h"
#include "fix_mdanim_leapfrog.h"
#include "stopwatch.h"

#include "angle.h"
#include "atom.h"
#include "comm.h"
#include "compute.h"
#include "dihedral.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
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
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>

using namespace LAMMPS_NS;
using namespace mdanim;

// Parts of a pass's time, as a pass without springs tells: drag is in the leap-frog's, and the springs have the rest.
static constexpr double OF_LEAPFROG = 0.15, OF_DRAG = 0.07, OF_GRAVITY = 0.01;

// What a fix may do in a step that we must know of.
static constexpr int ACTS = FixConst::INITIAL_INTEGRATE | FixConst::POST_INTEGRATE | FixConst::PRE_FORCE | FixConst::PRE_REVERSE |
    FixConst::POST_FORCE | FixConst::FINAL_INTEGRATE | FixConst::END_OF_STEP;
// Lists that particles may soon have left are made at once, not looked at again in a few steps.
static constexpr double SOON = 0.8;

// run_style verlet/mdanim [width common|avx2|avx512]
VerletMdanim::VerletMdanim(LAMMPS *lmp, int narg, char **arg) : Verlet(lmp, 0, arg), width(best_width())
{
  if (narg == 0) return;
  if (strcmp(arg[0], "width") != 0)
    error->all(FLERR, "run_style verlet/mdanim: unknown keyword {}; it knows width", arg[0]);
  if (narg != 2) error->all(FLERR, "run_style verlet/mdanim: width takes one word, common, avx2 or avx512");
  width = width_of(arg[1]);
  if (!width) error->all(FLERR, "run_style verlet/mdanim: width {} is unknown or this processor does not have it", arg[1]);
}

double VerletMdanim::memory_usage() { return static_cast<double>(blocks.bytes() + line.bytes()); }

// --- LAMMPS's list of bonds ---

// Lists are about to be made for the first time after init().
void VerletMdanim::setup(int flag)
{
  spare_bond_list();
  Verlet::setup(flag);
}

void VerletMdanim::setup_minimal(int flag)
{
  spare_bond_list();
  Verlet::setup_minimal(flag);
}

// Do without neighbor->bondlist, which takes 100 bytes per particle of a lattice and longer to make than many steps, where nobody can
// want it: our bond style reads springs from the particles that have them. Of fixes and computes only those count that are known to
// leave the list alone. It comes back with the next init().
void VerletMdanim::spare_bond_list()
{
  if (!dynamic_cast<BondMdanimHarmonic *>(force->bond) || force->pair || force->angle || force->dihedral || force->improper) return;
  const auto leaves_it = [](const char *style) {
    static constexpr const char *OTHERS[] = {"property/atom", "balance", "temp", "pressure", "pe", "ke"};
    return strncmp(style, "mdanim/", 7) == 0 ||
        std::any_of(std::begin(OTHERS), std::end(OTHERS), [style](const char *other) { return strcmp(style, other) == 0; });
  };
  const auto &fixes = modify->get_fix_list();
  const auto &computes = modify->get_compute_list();
  if (std::all_of(fixes.begin(), fixes.end(), [&](const Fix *fix) { return leaves_it(fix->style); }) &&
      std::all_of(computes.begin(), computes.end(), [&](const Compute *compute) { return leaves_it(compute->style); }))
    neighbor->set_overlap_topo(1);    // made by who calls build_topology()
}

// --- whether we can ---

// Everybody who acts in a step, if we know all of them.
bool VerletMdanim::find_players()
{
  bond = dynamic_cast<BondMdanimHarmonic *>(force->bond);
  leapfrog = nullptr;
  gravity = nullptr;
  guests.clear();
  strangers_have_lists = neighbor->nlist > 0;
  if (!bond || domain->triclinic || domain->dimension != 3) return false;
  if ((force->pair && force->pair->compute_flag) || force->angle || force->dihedral || force->improper || force->kspace)
    return false;
  for (int n = 0; n < modify->nfix; ++n) {
    Fix *fix = modify->fix[n];
    const int mask = modify->fmask[n];
    if (auto *found = dynamic_cast<FixMdanimLeapfrog *>(fix)) {
      if (leapfrog) return false;
      leapfrog = found;
    } else if (auto *found = dynamic_cast<FixMdanimGravity *>(fix)) {
      if (gravity || !guests.empty()) return false;    // its force is added right after the springs'
      gravity = found;
    } else if (auto *guest = dynamic_cast<Guest *>(fix))
      guests.push_back({fix, guest, (mask & FixConst::END_OF_STEP) != 0});
    else if (mask & ACTS)
      return false;
    else if (mask & FixConst::POST_NEIGHBOR)
      strangers_have_lists = true;
  }
  const bool periodic = domain->xperiodic || domain->yperiodic || domain->zperiodic;
  if (comm->nprocs > 1 && (periodic || neighbor->build_once)) return false;
  // With several ranks nobody may go beyond the neighbours of his own unseen.
  lists_matter = modify->n_post_neighbor || modify->n_pre_neighbor || comm->nprocs > 1;
  return leapfrog && !(lists_matter && !neighbor->dist_check && !neighbor->build_once);
}

// Blocks for the springs as they are now.
bool VerletMdanim::cut()
{
  if (comm->nprocs > 1) return cut_for_ranks();
  HalfBonds half;
  if (atom->nghost || !bond->halves(half)) return false;
  const bool other_objects = made_for < 0 && atom->molecule_flag &&
      !(static_cast<int>(object.size()) == atom->nlocal && std::equal(object.begin(), object.end(), atom->molecule));
  if (cut_for != bond->version() || other_objects) {
    object.assign(atom->nlocal, 1);
    if (atom->molecule_flag) std::copy_n(atom->molecule, atom->nlocal, object.begin());
    worth_it = blocks.cut(half, object.data(), *width);
    cut_for = bond->version();
    made_for = -1;
  }
  return worth_it;
}

// The same, once after every rebuild, if all ranks can.
bool VerletMdanim::cut_for_ranks()
{
  if (decided_for == neighbor->lastcall) return worth_it;
  decided_for = neighbor->lastcall;
  int here = cut_line(), all = 0;
  MPI_Allreduce(&here, &all, 1, MPI_INT, MPI_MIN, world);
  return worth_it = all;
}

// Whether this rank's particles and their ghosts are in blocks.
bool VerletMdanim::cut_line()
{
  std::vector<int> objects;
  leapfrog->survey_ghosts(sent, objects);
  BondRows rows;
  if (!bond->rows_of_all(rows)) return false;
  Lineup now(atom->nlocal, atom->nlocal + atom->nghost, atom->tag, rows);
  std::vector<int> of_line;
  for (const int i : now.places()) of_line.push_back(objects[i]);
  const bool same = cut_for >= 0 && object == of_line && now.same_springs(line);
  line = std::move(now);
  object = std::move(of_line);
  cut_for = 0;
  if (!same) blocks.cut(line.halves(), object.data(), *width);
  if (!blocks.ready()) return false;
  blocks.lie_at(line.places(), atom->nlocal);
  return true;
}

// --- the run ---

void VerletMdanim::run(int n)
{
  if (!find_players()) {
    Verlet::run(n);
    return;
  }
  made_for = decided_for = -1;
  for (int i = 0; i < n; ++i) {
    if (timer->check_timeout(i)) {
      update->nsteps = i;
      break;
    }
    begin_step();
    if (cut()) i += take_steps(i, n - 1 - i);
    finish_step();
  }
}

// The step at which somebody wants to see everything.
bigint VerletMdanim::next_stop() const
{
  bigint stop = output->next;
  for (int n = 0; n < modify->nfix; ++n) {
    const Fix *fix = modify->fix[n];
    if (fix->force_reneighbor && fix->next_reneighbor >= update->ntimestep) stop = std::min(stop, fix->next_reneighbor);
  }
  return stop;
}

// Up to `most` times: finish the step that has begun and begin the next. Returns how often.
int VerletMdanim::take_steps(int step, int most)
{
  const bigint stop = std::min(next_stop(), update->ntimestep + most);
  if (update->ntimestep >= stop) return 0;
  if (lists_matter) {
    last = how_far_lists_last();
    strayed = farthest();
    if (!lists_last(0.0)) return 0;
  }

  timer->stamp();
  if (comm->nprocs > 1) comm->forward_comm();
  start_blocks();
  int taken = 0;
  bool stand = true;
  while (update->ntimestep < stop) {
    if (comm->nprocs > 1 && taken) meet_ghosts();
    bool see_all = false;
    for (const Player &p : guests) see_all = p.guest->reads_all() || see_all;
    if (see_all) blocks.hold_back(wanted, true);
    one_pass(see_all);
    ++taken;
    ++passed;
    ++update->ntimestep;
    ++neighbor->ago;
    if (timer->check_timeout(step + taken)) break;
    if (!lists_matter || lists_last(update->dt * std::sqrt(pass.fastest))) continue;
    if (comm->nprocs > 1 || update->ntimestep >= stop) break;
    stand = look_again();
    if (!stand) break;
  }
  if (stand) leave_blocks();
  timer->stamp(Timer::BOND);
  ev_set(update->ntimestep);
  return taken;
}

// Positions and velocities out of the blocks, and the account of dashpots as it stands.
void VerletMdanim::leave_blocks()
{
  blocks.give_out(atom->x, atom->v);
  Loss *account = bond->account();
  if (!account) return;
  if (blocks.damped()) blocks.give_out_dashpots(account->latest(), account->latest_seen());
  account->reopen();
}

// How far any particle of this rank is from where it stood when lists were made.
double VerletMdanim::farthest() const
{
  const double *const *here = atom->x, *const *then = neighbor->get_xhold();
  double most = 0.0;
  for (int i = 0; i < atom->nlocal; ++i) {
    const Vec3 d = vec3(here[i]) - vec3(then[i]);
    most = std::max(most, dot(d, d));
  }
  return std::sqrt(most);
}

// How far any particle may go before lists must be made anew: half the skin, and farther if nobody needs them until then. The
// springs' partners stay who they are; with other ranks, nobody may pass by a whole rank unseen.
double VerletMdanim::how_far_lists_last() const
{
  const double half = 0.5 * neighbor->skin;
  if (strangers_have_lists) return half;
  double far = std::numeric_limits<double>::max();
  for (const Player &p : guests) far = std::min(far, p.guest->looks_ahead());
  if (comm->nprocs > 1) {
    for (int d = 0; d < 3; ++d) far = std::min(far, 0.5 * (domain->subhi[d] - domain->sublo[d]));
    MPI_Allreduce(MPI_IN_PLACE, &far, 1, MPI_DOUBLE, MPI_MIN, world);
  }
  return std::max(half, far);
}

// Whether no particle of any rank can have moved so far, going `more` farther.
bool VerletMdanim::lists_last(double more)
{
  strayed += more;
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, &strayed, 1, MPI_DOUBLE, MPI_MAX, world);
  return strayed < last;
}

// Between two passes of a rank that is alone: sees how far particles really are and makes lists anew if need be. False where particles
// have changed places then: the blocks do not stand any more.
bool VerletMdanim::look_again()
{
  timer->stamp(Timer::BOND);
  blocks.give_out(atom->x, atom->v);
  strayed = farthest();
  if (strayed < SOON * last) return true;
  leave_blocks();
  if (!rebuild_lists()) return false;
  strayed = 0.0;
  last = how_far_lists_last();
  start_blocks();
  return true;
}

// Other ranks see where this one's particles are, and this one theirs.
void VerletMdanim::meet_ghosts()
{
  timer->stamp(Timer::BOND);
  blocks.give_out_places(sent, atom->x, comm->ghost_velocity ? atom->v : nullptr);
  comm->forward_comm();
  blocks.take_in_ghosts(atom->x, atom->v);
  timer->stamp(Timer::COMM);
}

// Positions and velocities into the blocks, and who is to be held back.
void VerletMdanim::start_blocks()
{
  if (made_for != neighbor->lastcall) {
    blocks.set_motion(leapfrog->friction(), [this](int i) {
      Mover mover = leapfrog->mover(i);
      if (gravity) mover.pulled = gravity->pulled(i);
      return mover;
    });
    made_for = neighbor->lastcall;
  }
  blocks.take_in(atom->x, atom->v);
  if (Loss *account = bond->account()) {
    account->close(atom->v, update->dt);
    if (blocks.damped()) blocks.take_in_dashpots(account->latest(), account->latest_seen());
  }
  blocks.fill(pass, atom->f);
  pass.gravity[0] = pass.gravity[1] = pass.gravity[2] = 0.0;
  if (gravity) {
    const Vec3 &g = gravity->acceleration();
    pass.gravity[0] = g.x, pass.gravity[1] = g.y, pass.gravity[2] = g.z;
  }
  pass.trace = leapfrog->trace_bounds();
  hold_back();
}

void VerletMdanim::hold_back()
{
  wanted.clear();
  for (const Player &p : guests) p.guest->concerned(wanted);
  blocks.hold_back(wanted, false);
  pass.friction = blocks.friction_acts() ? leapfrog->friction() : Friction::NONE;    // without any it is the same, and faster
}

void VerletMdanim::one_pass(bool guests_see_all)
{
  double all = 0.0;
  {
    const Lap lap(all);
    width->pass(pass);
  }
  const double moving = (OF_LEAPFROG + (pass.friction == Friction::NONE ? 0.0 : OF_DRAG)) * all;
  const double pulling = gravity ? OF_GRAVITY * all : 0.0;
  leapfrog->moved(pass.final_loss, pass.first_loss, moving);
  if (gravity) gravity->took(pulling);
  bond->took(all - moving - pulling);
  if (!guests.empty()) {
    guests_turn();
    if (guests_see_all) hold_back();    // they may have other concerns now
  }
  if (Loss *account = bond->account()) account->passed(pass.dashpots, update->dt);
}

// Forces of other fixes, and the motion of those that were held back for them.
void VerletMdanim::guests_turn()
{
  const std::vector<int> &waiting = blocks.held_back();
  if (!waiting.empty()) {
    blocks.give_out_held_back(atom->x, atom->v);
    blocks.give_out_forces(atom->f);
  }
  for (const Player &p : guests) p.fix->post_force(vflag);
  if (!waiting.empty()) leapfrog->finish_step(waiting);
  for (const Player &p : guests)
    if (p.acts_at_end) p.fix->end_of_step();
  if (waiting.empty()) return;
  leapfrog->begin_step(waiting);
  if (blocks.damped()) blocks.count_held_back(atom->v, pass.dashpots);
  blocks.take_in_held_back(atom->x, atom->v);
  for (const int i : waiting) pass.fastest = std::max(pass.fastest, dot(vec3(atom->v[i]), vec3(atom->v[i])));
}

// --- a step of run_style verlet, in two parts ---

void VerletMdanim::begin_step()
{
  ev_set(++update->ntimestep);
  timer->stamp();
  modify->initial_integrate(vflag);
  timer->stamp(Timer::MODIFY);
}

void VerletMdanim::finish_step()
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

// As LAMMPS decides it, but later if nobody needs lists now; a file gets the box of now.
bool VerletMdanim::lists_are_due()
{
  const bigint now = update->ntimestep;
  if (neighbor->lastcall == now) return false;    // look_again() has made them; `ago` still says so
  if (neighbor->build_once || now == output->next_dump_any || now == output->next_restart) return neighbor->decide();
  for (const Fix *fix : modify->get_fix_list())
    if (fix->force_reneighbor && fix->next_reneighbor == now) return true;
  last = how_far_lists_last();
  if (last <= 0.5 * neighbor->skin) return neighbor->decide();
  ++neighbor->ago;
  strayed = farthest();
  return !lists_last(0.0);
}

// Returns whether every particle is where it was in the arrays.
bool VerletMdanim::rebuild_lists()
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
  // LAMMPS's own list of bonds takes longer than a step to make; it stands as long as nobody changes places.
  const bool same = comm->nprocs == 1 && !sorted && atom->nghost == 0 && atom->nlocal == before &&
      modify->get_fix_by_style("^bond/").empty();
  neighbor->build(same ? 0 : 1);
  timer->stamp(Timer::NEIGH);
  if (modify->n_post_neighbor) modify->post_neighbor();
  timer->stamp(Timer::MODIFY);
  return same;
}
