// SPDX-License-Identifier: GPL-2.0-only
// run_style verlet/mdanim. A step of LAMMPS begins with a half kick and a drift and finishes with forces and the other half kick.
// Between two outputs our pass finishes a step and begins the next at once, in arrays of its own; whoever is not known to live
// with that (other fixes) gets run_style verlet as it is. The bits are the same. With other ranks, ghosts are lanes that do not
// move: they get their places and, for dashpots, velocities before every pass, and what springs do to them is thrown away. Ranks
// decide together.

#include "styles/verlet_mdanim.h"

#include "engine/boxes.h"
#include "engine/stopwatch.h"
#include "styles/bond_mdanim_harmonic.h"
#include "styles/fix_mdanim_gravity.h"
#include "styles/fix_mdanim_leapfrog.h"
#include "styles/patience.h"

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
// Lists are made at once, not looked at again in a few steps, when less than this part of the way is left.
static constexpr double SOON = 0.2;
// Sum of the squares of velocities above which passes are left to the plain step, and the way that stands for that.
static constexpr double LARGEST_SQUARE = 1e200, OVERFLOW = std::numeric_limits<double>::infinity();

// run_style verlet/mdanim [width common|avx2|avx512]
VerletMdanim::VerletMdanim(LAMMPS *lmp, int narg, char **arg) : Verlet(lmp, 0, arg)
{
  if (narg == 0) return;
  if (strcmp(arg[0], "width") != 0) error->all(FLERR, "run_style verlet/mdanim: unknown keyword {}; it knows width", arg[0]);
  if (narg != 2) error->all(FLERR, "run_style verlet/mdanim: width takes one word, common, avx2 or avx512");
  told = kernels_named(arg[1]);
  int here = told != nullptr, everywhere = 0;    // hosts may have different processors
  MPI_Allreduce(&here, &everywhere, 1, MPI_INT, MPI_MIN, world);
  if (!everywhere)
    error->all(
        FLERR,
        "run_style verlet/mdanim: width {} is unknown or {} does not have it; leave width out, and every rank takes its best",
        arg[1], comm->nprocs > 1 ? "the processor of some rank" : "this processor");
}

double VerletMdanim::memory_usage()
{
  return static_cast<double>(blocks.bytes() + line.bytes() + ghosts.bytes() +
                             (object.capacity() + sent.capacity() + wanted.capacity()) * sizeof(int) + places.bytes());
}

// --- LAMMPS's list of bonds ---

// Lists are about to be made for the first time after init().
void VerletMdanim::setup(int flag)
{
  decided_for = -1;
  line.forget();    // particles may have other springs now
  whole_way_for = local_then = -1;
  spare_bond_list();
  Verlet::setup(flag);
}

void VerletMdanim::setup_minimal(int flag)
{
  decided_for = -1;
  line.forget();
  whole_way_for = local_then = -1;
  spare_bond_list();
  Verlet::setup_minimal(flag);
}

// Do without neighbor->bondlist, which takes 100 bytes per particle of a lattice and longer to make than many steps, where nobody
// can want it: our bond style reads springs from the particles that have them. Of fixes and computes only those count that are
// known to leave the list alone. It comes back with the next init().
void VerletMdanim::spare_bond_list()
{
  if (!dynamic_cast<BondMdanimHarmonic *>(force->bond) || force->pair || force->angle || force->dihedral || force->improper)
    return;
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
  early.clear();
  late.clear();
  strangers_have_lists = neighbor->nlist > 0;
  if (!bond || domain->triclinic || domain->dimension != 3) return false;
  if ((force->pair && force->pair->compute_flag) || force->angle || force->dihedral || force->improper || force->kspace)
    return false;
  if (bond->refresh_coefficients()) decided_for = -1;
  const Kernels *now = told ? told : &best_kernels(bond->account() != nullptr);
  if (now != kernels) cut_for = decided_for = -1;
  kernels = now;
  for (int n = 0; n < modify->nfix; ++n) {
    Fix *fix = modify->fix[n];
    const int mask = modify->fmask[n];
    if (auto *found = dynamic_cast<FixMdanimLeapfrog *>(fix)) {
      if (leapfrog) return false;
      leapfrog = found;
    } else if (auto *found = dynamic_cast<FixMdanimGravity *>(fix)) {
      if (gravity || !early.empty() || !late.empty()) return false;    // its force is added right after the springs'
      gravity = found;
    } else if (auto *participant = dynamic_cast<PassParticipant *>(fix)) {
      participant->set_pair_filter(kernels->pair_filter);
      // Whoever comes after a late one is late himself: forces are added in the order of fixes.
      (participant->depends_on_positions_only() && late.empty() ? early : late)
          .push_back({fix, participant, (mask & FixConst::END_OF_STEP) != 0});
    } else if (mask & ACTS)
      return false;
    else if (mask & FixConst::POST_NEIGHBOR)
      strangers_have_lists = true;
  }
  const bool periodic = domain->xperiodic || domain->yperiodic || domain->zperiodic;
  // Blocks do not know of images, and with several ranks no particle may go beyond the neighbours of its own unseen.
  if (periodic || (comm->nprocs > 1 && neighbor->build_once)) return false;
  lists_matter = !neighbor->build_once && (modify->n_post_neighbor || modify->n_pre_neighbor || comm->nprocs > 1);
  return leapfrog && !(lists_matter && !neighbor->dist_check);    // without that check LAMMPS does not keep where particles stood
}

// SimdBlocks for the springs as they are now.
bool VerletMdanim::cut()
{
  if (comm->nprocs > 1) return cut_for_ranks();
  HalfBonds half;
  if (atom->nghost || !bond->halves(half)) return false;
  const bool other_objects =
      made_for < 0 && atom->molecule_flag &&
      !(static_cast<int>(object.size()) == atom->nlocal && std::equal(object.begin(), object.end(), atom->molecule));
  if (cut_for != bond->version() || other_objects) {
    object.assign(atom->nlocal, 1);
    if (atom->molecule_flag) std::copy_n(atom->molecule, atom->nlocal, object.begin());
    blocks.start(kernels->lanes);
    const Cut whole = blocks.cut(half, object.data());
    worth_it = blocks.put_together({&whole}).worth_it();
    if (worth_it) blocks.lay_out();
    cut_for = bond->version();
    made_for = -1;
  }
  return worth_it;
}

// The same, once after every rebuild. All ranks or none: some have few particles, or none, and count for as little.
bool VerletMdanim::cut_for_ranks()
{
  if (decided_for == neighbor->ncalls) return worth_it;
  decided_for = neighbor->ncalls;
  std::vector<Home> home;
  const LaneUse here = cut_line(home);
  double all[] = {here.springs, here.lanes};
  MPI_Allreduce(MPI_IN_PLACE, all, 2, MPI_DOUBLE, MPI_SUM, world);
  worth_it = LaneUse{all[0], all[1]}.worth_it();
  if (worth_it) ghosts.survey(world, home, blocks);
  return worth_it;
}

// This rank's particles and their ghosts into blocks. Tells where the ghosts are at home.
LaneUse VerletMdanim::cut_line(std::vector<Home> &home)
{
  const std::vector<FixMdanimLeapfrog::Known> known = leapfrog->survey_ghosts(sent);
  object.clear();
  for (const auto &one : known) object.push_back(one.object);
  line.take({atom->nlocal, atom->tag, object.data(), atom->num_bond, atom->bond_type, atom->bond_atom,
             [this](int partner) { return atom->map(partner); }, [this](int i, int partner) { bond->lost_partner(i, partner); }});
  for (const int i : line.places())
    if (i >= atom->nlocal) home.push_back(known[i].home);
  if (cut_for < 0 || laws != bond->laws() || blocks.laws_pile_up()) {
    blocks.start(kernels->lanes);
    for (TagOrder::Piece &piece : line.pieces()) piece.is_cut = false;
    laws = bond->laws();
    cut_for = 0;
    line_use = {};
  }
  if (line.changed() || line_use.lanes == 0.0) {
    std::vector<const Cut *> cuts;
    for (TagOrder::Piece &piece : line.pieces()) {
      if (!piece.is_cut) piece.cut = blocks.cut({&piece.rows, bond->laws().data()}, piece.object.data());
      piece.is_cut = true;
      cuts.push_back(&piece.cut);
    }
    line_use = blocks.put_together(cuts);
  }
  blocks.lay_out_at(line.places(), atom->nlocal);
  return line_use;
}

// --- the run ---

void VerletMdanim::run(int n)
{
  refuse_if_moved();
  if (find_players())
    run_passes(n);
  else
    Verlet::run(n);
  local_then = atom->nlocal;
  ghosts_then = atom->nghost;
}

void VerletMdanim::run_passes(int n)
{
  made_for = -1;
  overflowed = false;
  for (int i = 0; i < n; ++i) {
    if (timer->check_timeout(i)) {
      update->nsteps = i;
      break;
    }
    begin_step();
    if (!overflowed && cut()) i += take_steps(i, n - 1 - i);
    finish_step();
  }
}

// LAMMPS itself asks for a setup here, but does not see where it is left out.
void VerletMdanim::refuse_if_moved()
{
  int moved = local_then >= 0 && (atom->nlocal != local_then || atom->nghost != ghosts_then), anywhere = 0;
  MPI_Allreduce(&moved, &anywhere, 1, MPI_INT, MPI_MAX, world);
  if (anywhere)
    error->all(FLERR, "run_style verlet/mdanim: particles were added, deleted or given to other ranks since the last run; "
                      "leave out 'pre no' of this one");
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
  const double overflow = overflows() ? OVERFLOW : 0.0;
  if (lists_matter) {
    tell_limits();
    left = way_left();
    if (!lists_last(overflow)) return 0;
    if (whole_way_for != neighbor->ncalls) way_begins();
  } else if (overflow > 0.0) {
    overflowed = true;
    return 0;
  }

  timer->stamp();
  if (comm->nprocs > 1) comm->forward_comm();
  blocks.take_in(atom->x, atom->v);
  prepare_passes();
  int taken = 0;
  bool stand = true;
  ghosts_are_met = true;
  while (update->ntimestep < stop) {
    if (comm->nprocs > 1 && !ghosts_are_met) meet_ghosts();
    ghosts_are_met = false;
    bool see_all = false;
    for (const Player &p : late) see_all = p.participant->needs_all_atoms() || see_all;
    if (see_all) blocks.hold_back(wanted, true);
    one_pass(see_all);
    ++taken;
    ++passed;
    ++update->ntimestep;
    ++neighbor->ago;
    if (timer->check_timeout(step + taken)) break;
    const bool in_range = pass.squares < LARGEST_SQUARE;
    if (lists_matter ? lists_last(in_range ? update->dt * std::sqrt(pass.fastest) : OVERFLOW) : in_range) continue;
    overflowed = overflowed || !in_range;
    if (overflowed || update->ntimestep >= stop) break;
    stand = look_again();
    if (!stand) break;
  }
  if (stand) leave_blocks();
  timer->stamp(Timer::BOND);
  ev_set(update->ntimestep);
  return taken;
}

// Whether a position or a velocity here is so large, or no number, that a lane without a spring, which is multiplied by zero,
// would not stay zero in a pass: the particles of another object may be in that lane. The plain step has no such lanes.
bool VerletMdanim::overflows() const
{
  double squares = 0.0;
  for (int i = 0; i < atom->nlocal; ++i)
    squares += dot(vec3(atom->x[i]), vec3(atom->x[i])) + dot(vec3(atom->v[i]), vec3(atom->v[i]));
  return !(squares < LARGEST_SQUARE);
}

// Positions and velocities out of the blocks.
void VerletMdanim::leave_blocks()
{
  blocks.give_out(atom->x, atom->v);
  give_out_account();
}

// The account of dashpots as it stands.
void VerletMdanim::give_out_account()
{
  Loss *account = bond->account();
  if (!account) return;
  if (blocks.damped()) blocks.give_out_dashpots(account->latest(), account->latest_seen());
  account->reopen();
}

// Half the skin, and farther if nobody needs lists until then: the springs' partners stay who they are.
void VerletMdanim::tell_limits()
{
  const double half = 0.5 * neighbor->skin;
  limit = limit_but_for_drift = half;
  if (strangers_have_lists) return;
  double far = std::numeric_limits<double>::max(), far_but_for_drift = far;
  for (const auto *participants : {&early, &late})
    for (const Player &p : *participants) {
      double &of_participant = p.participant->sees_absolute_position() ? far : far_but_for_drift;
      of_participant = std::min(of_participant, p.participant->safe_displacement());
    }
  if (comm->nprocs > 1) {
    double least[] = {far, far_but_for_drift, 1.0, 1.0, 1.0};
    for (int d = 0; d < 3; ++d) least[2 + d] = (domain->subhi[d] - domain->sublo[d]) / domain->prd[d];
    MPI_Allreduce(MPI_IN_PLACE, least, 5, MPI_DOUBLE, MPI_MIN, world);
    far = least[0], far_but_for_drift = least[1];
    std::copy(least + 2, least + 5, narrowest);
  }
  limit = std::max(half, far);
  limit_but_for_drift = std::max(half, far_but_for_drift);
}

// As particles of this rank stand now, particle i at where(i). Two of them have not come nearer to each other by more than the
// longest way through the box around all displacements; so each has gone half of it, but for drift.
template <class Where> double VerletMdanim::way_left(Where where) const
{
  const double *const *then = neighbor->get_xhold();
  const bool alone = comm->nprocs == 1;
  double most = 0.0;
  Box displaced, now;
  for (int i = 0; i < atom->nlocal; ++i) {
    const Vec3 here = where(i), d = here - vec3(then[i]);
    const double of_box[] = {d.x, d.y, d.z}, at[] = {here.x, here.y, here.z};
    most = std::max(most, dot(d, d));
    displaced.include(of_box);
    if (!alone) now.include(at);
  }
  const double gone = std::sqrt(most);
  if (alone) return std::min(limit - gone, limit_but_for_drift - std::min(gone, 0.5 * displaced.diagonal()));
  Box all[] = {displaced, now};
  MPI_Allreduce(MPI_IN_PLACE, all[0].bound, 12, MPI_DOUBLE, MPI_MIN, world);
  const double way = std::min(limit - gone, limit_but_for_drift - std::min(gone, 0.5 * all[0].diagonal()));
  return std::max(0.5 * neighbor->skin - gone, std::min(way, way_to_strangers(now, all[1])));
}

double VerletMdanim::way_left() const
{
  return way_left([this](int i) { return vec3(atom->x[i]); });
}

// How much farther this rank's particles, which are within `own`, may go before one may have passed half a rank unseen: LAMMPS
// hands them on to the ranks beside alone, which have their shares of the box around all particles, `all`, when they are handed
// on.
double VerletMdanim::way_to_strangers(const Box &own, const Box &all) const
{
  double way = std::numeric_limits<double>::max();
  for (int d = 0; d < 3 && !own.empty(); ++d) {
    const double from = domain->boxlo[d], low = domain->sublo[d], high = domain->subhi[d];
    const double from_now = follows(d, 0) ? all.low(d) : from;
    const double length = (follows(d, 1) ? all.high(d) : domain->boxhi[d]) - from_now, stretch = length / domain->prd[d];
    const double half = 0.5 * narrowest[d] * length;
    if (low > from) way = std::min(way, own.low(d) - (from_now + stretch * (low - from)) + half);
    if (high < domain->boxhi[d]) way = std::min(way, from_now + stretch * (high - from) - own.high(d) + half);
  }
  return 0.5 * way;    // particle and share may move towards each other
}

// Whether a side of the box goes where particles are.
bool VerletMdanim::follows(int d, int side) const
{
  constexpr int SHRINK = 2;    // of LAMMPS's numbers of boundaries
  return domain->boundary[d][side] == SHRINK;
}

// Whether no particle of any rank can have gone so far, going `more` farther. OVERFLOW on one rank is heard by all.
bool VerletMdanim::lists_last(double more)
{
  left -= more;
  if (comm->nprocs > 1) {
    MPI_Request request;
    MPI_Iallreduce(MPI_IN_PLACE, &left, 1, MPI_DOUBLE, MPI_MIN, world, &request);
    wait_for(1, &request);
  }
  overflowed = overflowed || left == -OVERFLOW;
  return left > 0.0;
}

// Lists are new: from here on `left` gets less.
void VerletMdanim::way_begins()
{
  whole_way = left;
  whole_way_for = neighbor->ncalls;
}

// Between two passes: sees how far particles really are, and makes lists anew if need be. False where the blocks do not stand any
// more.
bool VerletMdanim::look_again()
{
  timer->stamp(Timer::BOND);
  left = way_left([this](int i) { return blocks.where(i); });
  // What dashpots did last is not handed on with particles: several ranks do that in a plain step, when lists are due.
  const bool between_passes = comm->nprocs == 1 || !bond->account();
  lists_last(0.0);
  if (left > (between_passes ? SOON * whole_way : 0.0)) return true;
  leave_blocks();
  if (!between_passes) return false;
  if (comm->nprocs > 1) {
    rebuild_lists();
    if (!cut()) return false;
  } else {
    if (!rebuild_lists()) return false;
    if (late.empty()) made_for = neighbor->ncalls;    // nobody has changed how particles move
  }
  tell_limits();
  left = comm->nprocs > 1 ? way_left() : std::min(limit, limit_but_for_drift);
  lists_last(0.0);
  way_begins();
  ghosts_are_met = true;
  // Mostly a rank that is alone has them where they were.
  if (comm->nprocs > 1 || modify->n_pre_exchange || modify->n_pre_neighbor) blocks.take_in(atom->x, atom->v);
  prepare_passes();
  return true;
}

// Other ranks see where this one's particles are, and this one theirs. Participants look for them in the arrays of LAMMPS.
void VerletMdanim::meet_ghosts()
{
  timer->stamp(Timer::BOND);
  if (participants_look) {
    blocks.give_out_places(sent, atom->x, comm->ghost_velocity ? atom->v : nullptr);
    comm->forward_comm();
    blocks.take_in_ghosts(atom->x, atom->v);
  } else {
    ghosts.meet(world, blocks, comm->ghost_velocity);
  }
  timer->stamp(Timer::COMM);
}

// What passes need to know besides positions and velocities: how particles move, who brings forces, and who is to be held back.
void VerletMdanim::prepare_passes()
{
  if (made_for != neighbor->ncalls) {
    blocks.set_motion(leapfrog->friction(), [this](int i) {
      Mover mover = leapfrog->mover(i);
      if (gravity) mover.pulled = gravity->pulled(i);
      return mover;
    });
    made_for = neighbor->ncalls;
  }
  if (Loss *account = bond->account()) {
    account->close(atom->v, update->dt);
    if (blocks.damped()) blocks.take_in_dashpots(account->latest(), account->latest_seen());
  }
  std::vector<std::vector<int>> of_early(early.size());
  for (std::size_t n = 0; n < early.size(); ++n) early[n].participant->append_required_atoms(of_early[n]);
  blocks.expect(of_early);
  participants_look =
      !late.empty() || std::any_of(of_early.begin(), of_early.end(), [](const auto &particles) { return !particles.empty(); });
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, &participants_look, 1, MPI_INT, MPI_MAX, world);
  blocks.fill(pass, atom->f);
  pass.gravity[0] = pass.gravity[1] = pass.gravity[2] = 0.0;
  if (gravity) {
    const Vec3 &g = gravity->acceleration();
    pass.gravity[0] = g.x, pass.gravity[1] = g.y, pass.gravity[2] = g.z;
  }
  pass.trace = leapfrog->trace_rows();
  hold_back();
}

void VerletMdanim::hold_back()
{
  wanted.clear();
  for (const Player &p : late) p.participant->append_required_atoms(wanted);
  blocks.hold_back(wanted, false);
  pass.friction = blocks.friction_acts() ? leapfrog->friction() : Friction::NONE;    // without any it is the same, and faster
}

void VerletMdanim::one_pass(bool participants_see_all)
{
  early_participants_turn();
  double all = 0.0;
  pass.bends = leapfrog->tells_of(update->ntimestep + 1);
  pass.looks = leapfrog->looks();
  {
    const Lap lap(all);
    kernels->pass(pass);
  }
  const double moving = (OF_LEAPFROG + (pass.friction == Friction::NONE ? 0.0 : OF_DRAG)) * all;
  const double pulling = gravity ? OF_GRAVITY * all : 0.0;
  leapfrog->moved(pass.final_loss, pass.first_loss, pass.bend, moving);
  if (gravity) gravity->took(pulling);
  bond->took(all - moving - pulling);
  if (!late.empty()) {
    late_participants_turn();
    if (participants_see_all) hold_back();    // they may have other concerns now
  }
  if (Loss *account = bond->account()) account->passed(pass.dashpots, update->dt);
}

// Forces that the pass is to add.
void VerletMdanim::early_participants_turn()
{
  blocks.clear_external_force();
  for (std::size_t n = 0; n < early.size(); ++n) {
    blocks.tell_places(n, atom->x, places);
    early[n].participant->add_forces(places, blocks.external_force_of(n));
  }
}

// Forces of the other fixes, and the motion of those that were held back for them.
void VerletMdanim::late_participants_turn()
{
  const std::vector<int> &waiting = blocks.held_back();
  moved_alone += static_cast<long long>(waiting.size());
  if (!waiting.empty()) {
    blocks.give_out_held_back(atom->x, atom->v);
    blocks.give_out_forces(atom->f);
  }
  for (const Player &p : late) p.fix->post_force(vflag);
  if (!waiting.empty()) leapfrog->finish_step(waiting);
  for (const Player &p : late)
    if (p.acts_at_end) p.fix->end_of_step();
  if (waiting.empty()) return;
  leapfrog->begin_step(waiting);
  if (blocks.damped()) blocks.count_held_back(atom->v, pass.dashpots);
  blocks.take_in_held_back(atom->x, atom->v);
  for (const int i : waiting) {
    const double square = dot(vec3(atom->v[i]), vec3(atom->v[i]));
    pass.fastest = std::max(pass.fastest, square);
    pass.squares += square;
  }
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
  if (neighbor->ago == 0 && neighbor->lastcall == now) return false;    // look_again() has made them; `ago` still says so
  if (neighbor->build_once || !neighbor->dist_check || now == output->next_dump_any || now == output->next_restart)
    return neighbor->decide();
  for (const Fix *fix : modify->get_fix_list())
    if (fix->force_reneighbor && fix->next_reneighbor == now) return true;
  tell_limits();
  if (std::max(limit, limit_but_for_drift) <= 0.5 * neighbor->skin) return neighbor->decide();
  ++neighbor->ago;
  left = way_left();
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
  const bool same =
      comm->nprocs == 1 && !sorted && atom->nghost == 0 && atom->nlocal == before && modify->get_fix_by_style("^bond/").empty();
  neighbor->build(same ? 0 : 1);
  timer->stamp(Timer::NEIGH);
  if (modify->n_post_neighbor) modify->post_neighbor();
  timer->stamp(Timer::MODIFY);
  return same;
}
