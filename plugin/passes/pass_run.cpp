// SPDX-License-Identifier: GPL-2.0-only
// Data that passes need, and the use of their results.

#include "passes/pass_run.h"

#include "numbers/stopwatch.h"
#include "passes/loss.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

// Parts of the time of a pass, which cannot be timed piece by piece: they follow from its time without springs, without drag and
// without gravity (bench/effects.py shares, which goes from 13 and 3 springs for each particle to none). The rest belongs to the
// springs.
static constexpr double OF_LEAPFROG = 0.35, OF_DRAG = 0.14, OF_GRAVITY = 0.01;

// Extra time of a pass for a particle in a liquid, relative to its time for any particle: bench/liquid.py, at rest over nothing
// near.
static constexpr double MORE_IN_LIQUID = 0.26;

// The same for a lane of a row at planes: bench/alone.py, walls.
static constexpr double MORE_AT_PLANE = 0.3;

PassRun::PassRun(SimdBlocks &blocks, const Kernels &kernels, const Threads &threads, const PassCrew &crew,
                 const AtomArrays &atoms, double dt, Fresh fresh)
    : blocks(blocks), kernels(kernels), threads(threads), crew(crew), atoms(atoms), dt(dt),
      ns(blocks.ranges().all().size() > 1 ? ns_of_pass(blocks.size(), blocks.damped()) : 0.0)
{
  if (fresh.positions) blocks.take_in(atoms.x, atoms.v);
  if (fresh.motion)
    phi_of_movers = blocks.set_motion(threads, crew.integrator->friction(), [&](int i) {
      Mover mover = crew.integrator->mover(i);
      if (crew.gravity) mover.pulled = crew.gravity->pulled(i);
      mover.in_liquid = crew.liquid && crew.liquid->is_near(i);
      return mover;
    });
  if (Loss *account = crew.springs->account()) {
    account->close(atoms.v, dt);
    blocks.forget_rates();
  }
  std::vector<std::vector<int>> of_early(crew.early.size());
  rests.assign(crew.early.size(), 0.0);
  seconds_at_planes.assign(crew.early.size(), 0.0);
  for (std::size_t n = 0; n < crew.early.size(); ++n) {
    at_planes.push_back(crew.early[n]->hand_over_planes());
    if (at_planes[n].empty()) crew.early[n]->append_required_atoms(of_early[n]);
  }
  blocks.expect(of_early, at_planes);
  look = !crew.late.empty() ||
         std::any_of(of_early.begin(), of_early.end(), [](const auto &particles) { return !particles.empty(); });
  blocks.fill(pass, atoms.f, dt);
  pass.gravity.works = crew.gravity && !crew.gravity->steady();
  if (crew.gravity && !pass.gravity.works) set_gravity();
  pass.trace = crew.integrator->trace_rows();
  chunk_sums.resize(blocks.chunks());
  pass.sums = chunk_sums.data();
  hold_back();
}

void PassRun::set_gravity()
{
  const Vec3 both = pass.gravity.works ? crew.gravity->turn_to_step() : Vec3{}, &g = crew.gravity->acceleration();
  pass.gravity.now[0] = g.x, pass.gravity.now[1] = g.y, pass.gravity.now[2] = g.z;
  pass.gravity.both[0] = both.x, pass.gravity.both[1] = both.y, pass.gravity.both[2] = both.z;
}

void PassRun::hold_back()
{
  wanted.clear();
  for (const PassParticipant *p : crew.late) p->append_required_atoms(wanted);
  blocks.hold_back(wanted, false);
  if (crew.liquid) {
    blocks.immerse(threads, *crew.liquid, crew.integrator->friction_of_particles(), pass);
    crew.liquid->split(&blocks.held_back());
  }
  // Without friction: the same, and faster. Passes without it know no liquid; a friction of 0 changes no bit.
  pass.friction = blocks.friction_acts() ? std::max(Friction::IMPLICIT, crew.integrator->friction()) : Friction::NONE;
}

void PassRun::step(long long next, const std::function<void(bool at_end)> &late)
{
  if (crew.liquid && crew.liquid->is_due()) update_liquid();
  bool needs_all = false;
  for (PassParticipant *p : crew.late) needs_all = p->needs_all_atoms() || needs_all;
  if (needs_all) {
    give_back_to_liquid();
    blocks.hold_back(wanted, true);
  }
  early_participants_turn();
  if (pass.gravity.works) set_gravity();
  double all = 0.0, looking = 0.0;
  if (crew.liquid && !crew.liquid->kept()) {
    const Lap lap(looking);
    blocks.look_up_surface(threads, *crew.liquid);
  }
  pass.bends = crew.integrator->tells_of(next);
  pass.looks = crew.integrator->looks();
  {
    const Lap lap(all);
    take_pass();
  }
  const double share_of_liquid = blocks.share_of_liquid(MORE_IN_LIQUID);
  double touching = 0.0;
  for (std::size_t n = 0; n < at_planes.size(); ++n) {
    const double of_planes = blocks.share_of_planes(n, MORE_AT_PLANE) * all;
    seconds_at_planes[n] += of_planes;
    touching += of_planes;
  }
  all -= touching;
  const double moving = (1.0 - share_of_liquid) * (OF_LEAPFROG + (pass.friction == Friction::NONE ? 0.0 : OF_DRAG)) * all;
  const double pulling = crew.gravity ? OF_GRAVITY * all : 0.0, lifting = share_of_liquid * all;
  crew.integrator->moved(sums.loss, sums.bend, std::max(pass.largest_phi, phi_of_movers), moving);
  if (crew.gravity) crew.gravity->took(pulling);
  if (pass.gravity.works) crew.gravity->worked(sums.pulled + pulled_at_held_back());
  if (crew.liquid) crew.liquid->acted(sums.liquid_work, sums.liquid_lost, pass.fastest_near, lifting + looking);
  crew.springs->took(all - moving - pulling - lifting);
  if (!crew.late.empty()) {
    late_participants_turn(late);
    if (needs_all) hold_back();    // they may need other particles now
  }
  for (double &rest : rests) rest -= dt * largest_speed();
  if (Loss *account = crew.springs->account()) account->passed(sums.dashpots, dt);
}

// The part of particles that are held back, before they move.
double PassRun::pulled_at_held_back()
{
  const std::vector<int> &waiting = blocks.held_back();
  if (!waiting.empty()) blocks.give_out_held_back(threads, atoms.x, atoms.v);
  double sum = 0.0;
  for (const int i : waiting)
    sum += crew.gravity->pulled(i) * dot({pass.gravity.both[0], pass.gravity.both[1], pass.gravity.both[2]}, vec3(atoms.v[i]));
  return sum;
}

void PassRun::take_pass()
{
  std::fill(chunk_sums.begin(), chunk_sums.end(), PassSums{});
  blocks.ranges().begin_pass(pass);
  const std::vector<Range> &ranges = blocks.ranges().all();
  of_range.assign(ranges.size(), pass);
  for (std::size_t n = 0; n < ranges.size(); ++n) of_range[n].range = &ranges[n];
  if (pass.trace && blocks.ranges().objects_are_mixed())
    for (Pass &one : of_range) kernels.pass(one);
  else
    threads.each(static_cast<int>(ranges.size()), ns, [this](int n) { kernels.pass(of_range[n]); });
  blocks.ranges().end_pass(pass);
  pass.fastest = pass.squares = pass.largest_phi = 0.0;
  pass.fastest_near = -1.0;
  for (const Pass &one : of_range) {
    pass.fastest = std::max(pass.fastest, one.fastest);
    pass.fastest_near = std::max(pass.fastest_near, one.fastest_near);
    pass.largest_phi = std::max(pass.largest_phi, one.largest_phi);
    pass.squares += one.squares;
  }
  sums = {};
  for (const PassSums &of_chunk : chunk_sums) {
    sums.loss += of_chunk.loss;
    sums.bend += of_chunk.bend;
    sums.pulled += of_chunk.pulled;
    sums.dashpots.work += of_chunk.dashpots.work;
    sums.dashpots.bend += of_chunk.dashpots.bend;
    sums.liquid_work += of_chunk.liquid_work;
    sums.liquid_lost += of_chunk.liquid_lost;
  }
}

// Forces that the pass adds.
void PassRun::early_participants_turn()
{
  for (std::size_t n = 0; n < crew.early.size(); ++n) {
    if (rests[n] > 0.0 || !at_planes[n].empty()) continue;
    blocks.tell_places(threads, n, atoms.x, place);
    crew.early[n]->add_forces(place, blocks.external_force_of(n));
    rests[n] = crew.early[n]->rests_for();
  }
}

// Forces of the other participants, and the motion of the particles that were held back for them.
void PassRun::late_participants_turn(const std::function<void(bool at_end)> &late)
{
  const std::vector<int> &waiting = blocks.held_back();
  moved_alone += static_cast<long long>(waiting.size());
  if (!waiting.empty()) {
    blocks.give_out_held_back(threads, atoms.x, atoms.v);
    blocks.give_out_forces(atoms.f);
  }
  late(false);
  if (!waiting.empty()) crew.integrator->finish_step(waiting);
  late(true);
  if (waiting.empty()) return;
  crew.integrator->begin_step(waiting);
  blocks.take_in_held_back(threads, atoms.x, atoms.v);
  for (const int i : waiting) {
    const double square = dot(vec3(atoms.v[i]), vec3(atoms.v[i]));
    pass.fastest = std::max(pass.fastest, square);
    pass.squares += square;
  }
}

double PassRun::largest_speed() const { return std::sqrt(pass.fastest); }

bool PassRun::in_range(const AtomArrays &atoms, int particles)
{
  double squares = 0.0;
  for (int i = 0; i < particles; ++i) {
    const Vec3 x = vec3(atoms.x[i]), v = vec3(atoms.v[i]);
    squares += dot(x, x) + dot(v, v);
  }
  return squares < LARGEST_SQUARE;
}

// From here on all particles are the liquid's own task again.
void PassRun::give_back_to_liquid()
{
  if (!crew.liquid) return;
  blocks.give_out_impulses(threads, *crew.liquid);
  crew.liquid->split(nullptr);
}

// Particles stay in the blocks, and the pass moves them as usual.
void PassRun::update_liquid()
{
  give_back_to_liquid();
  blocks.give_out(threads, atoms.x, atoms.v);
  crew.liquid->update_liquid();
  hold_back();    // other particles may be near it now
}

void PassRun::leave()
{
  give_back_to_liquid();
  blocks.give_out_planes(at_planes);
  for (std::size_t n = 0; n < at_planes.size(); ++n)
    if (!at_planes[n].empty()) crew.early[n]->take_back_planes(at_planes[n], seconds_at_planes[n]);
  blocks.give_out(threads, atoms.x, atoms.v);
  Loss *account = crew.springs->account();
  if (!account) return;
  if (blocks.damped()) blocks.give_out_dashpots(dt, account->latest(), account->latest_seen());
  account->reopen(dt);
}

}    // namespace mdanim
