// SPDX-License-Identifier: GPL-2.0-only
// Particles in blocks for the vector units, and their state in arrays of their own (pass.h).

#pragma once

#include "geometry/aligned_array.h"
#include "numbers/vec3.h"
#include "passes/block_ranges.h"
#include "passes/cutter.h"
#include "passes/external_forces.h"
#include "passes/immersed_blocks.h"
#include "passes/pass.h"
#include "passes/pass_participant.h"
#include "threads/team.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <vector>

namespace mdanim {

// Sets a lane of a row of Pass::motion.
void set_motion(const Mover &mover, Friction friction, int lanes, int lane, double *row);

// Particles in blocks, laid out: their positions, velocities and forces in arrays of their own, one for each component, and the
// work for them in a pass. There is no such object before particles are cut and their order is known.
class SimdBlocks {
 public:
  // Blocks of a cut of all particles, which are in the same order in the arrays of LAMMPS.
  SimdBlocks(const Cutter &cutter, Cut &&cut, RangeCut &&ranges);
  // Particles are in another order in the arrays of LAMMPS: those from `own` on are ghosts, which others move. All other
  // functions number them as LAMMPS does: mover(), expect(), hold_back(), held_back().
  SimdBlocks(const Cutter &cutter, Cut &&cut, RangeCut &&ranges, const std::vector<int> &places, int own);
  SimdBlocks(const SimdBlocks &) = delete;
  SimdBlocks &operator=(const SimdBlocks &) = delete;
  void lay_out_at(const std::vector<int> &places, int own);    // the same blocks when the order in LAMMPS's arrays has changed

  int size() const { return particles; }
  bool damped() const { return has_damped; }    // some block is
  int chunks() const { return many_chunks; }

  // Takes in how particles move: Mover mover(int i), which threads ask side by side. Returns the largest phi of all.
  template <class Tell> double set_motion(const Threads &threads, Friction friction, const Tell &mover);
  // Forces that participants give, see ExternalForces. Particles are numbered as LAMMPS does.
  void expect(const std::vector<std::vector<int>> &particles, const PlaneBlocks::OfProviders &points);
  void tell_places(const Threads &threads, std::size_t n, const double *const *of_ghosts, Positions &to) const
  { external.tell_places(threads, n, x, of_ghosts, to); }
  ForceSums external_force_of(std::size_t n) { return external.of(n); }
  void give_out_planes(PlaneBlocks::OfProviders &points) const { external.planes().give_out(points); }
  long points_at_planes() const { return external.planes().points(); }    // whose contacts passes compute
  // Share of a participant's planes in the time of a pass in which a particle at a plane takes `more` than another.
  double share_of_planes(std::size_t n, double more) const
  { return more * external.planes().particles_of(n) / (particles + more * external.planes().particles()); }

  // Holds back every block with one of these particles, and no other; ghosts among them are left out.
  void hold_back(const std::vector<int> &particles, bool everything);
  bool friction_acts() const;                                                            // on a block that is not held back
  const std::vector<int> &held_back() const { return reordered ? waiting : outside; }    // all particles of such blocks

  // Sets the blocks that a liquid acts on, with its coefficients; blocks that are held back as well are left out. The second
  // function gives the impulses on the liquid back to it.
  void immerse(const Threads &threads, PassLiquid &liquid, const double *lambda, Pass &pass);
  void look_up_surface(const Threads &threads, const PassLiquid &liquid) { immersed.look_up(threads, liquid, all, x); }
  void give_out_impulses(const Threads &threads, PassLiquid &liquid) const;
  // Share of the liquid in the time of a pass in which a particle in the liquid takes `more` than another, relative to that.
  double share_of_liquid(double more) const { return more * immersed.particles() / (particles + more * immersed.particles()); }

  void take_in(const double *const *x, const double *const *v);
  void give_out(const Threads &threads, double *const *x, double *const *v) const;
  // The same for the particles that are held back.
  void take_in_held_back(const Threads &threads, const double *const *x, const double *const *v);
  void give_out_held_back(const Threads &threads, double *const *x, double *const *v) const;

  // Where damped: the first pass after this knows no strain rates of the step before.
  void forget_rates() { rate.assign(rate.size()); }
  // Where damped: forces of dashpots in the last step, and the velocities that they were computed with, of all own particles.
  void give_out_dashpots(double dt, std::vector<Vec3> &force, std::vector<Vec3> &seen) const;

  // With ghosts: gives out positions of these own particles, which other ranks wait for, and velocities unless v is null; and
  // takes in those of ghosts.
  void give_out_places(const std::vector<int> &particles, double *const *x, double *const *v) const;
  void take_in_ghosts(const double *const *x, const double *const *v);
  // The same from blocks to blocks, for particles in our own order: three numbers for each, or six with velocities.
  Vec3 where(int i) const { return {x[0][ours(i)], x[1][ours(i)], x[2][ours(i)]}; }    // an own particle in LAMMPS's order
  int place_of(int i) const { return place[i]; }                                       // of an own particle, in that order
  const std::vector<int> &ghost_places() const { return ghosts; }
  void pack(const std::vector<int> &particles, bool velocities, double *to) const;
  void unpack(const std::vector<int> &particles, bool velocities, const double *from);

  void fill(Pass &pass, double *const *f, double dt);    // f: where forces on those that are held back go
  BlockRanges &ranges() { return range; }
  const BlockRanges &ranges() const { return range; }
  void give_out_forces(double *const *f) const;    // forces are there after a pass and this call
  std::size_t bytes() const;

 private:
  static constexpr double PARTICLE = 8.0;    // time to copy one into the arrays of LAMMPS or out of them [ns], approximately
  // Calls work(i) for all particles that are held back, shared among threads.
  template <class Work> void each_outside(const Threads &threads, const Work &work) const
  {
    threads.parts(static_cast<long>(outside.size()), PARTICLE, [&](long from, long to) {
      for (long n = from; n < to; ++n) work(outside[n]);
    });
  }
  int at(int i) const { return reordered ? index[i] : i; }
  int ours(int i) const { return reordered ? place[i] : i; }    // the way back
  bool is_ghost(int place) const { return reordered && place >= owned; }
  // The index in LAMMPS's arrays of the own particle at a place; -1 for a ghost.
  auto own_particle() const
  {
    return [this](int i) {
      const int found = at(i);
      return is_ghost(found) ? -1 : found;
    };
  }
  // A row of Pass::motion, the largest phi of its particles, in passes or in the liquid, and whether any of them moves.
  struct BlockMotion {
    std::vector<double> row;
    double phi;
    bool slow, moves;
  };
  template <class Tell> void tell_motion(const Block &block, Friction friction, const Tell &mover, BlockMotion &to) const;
  template <class Tell>
  bool move_as_before(const Threads &threads, Friction friction, const Tell &mover, double &largest_phi) const;
  unsigned number_rates();
  // Calls visit(entry, first particle of its block, row of Pass::rate) for all entries of damped blocks.
  template <class Visit> void each_damped_entry(const Visit &visit) const;
  void set_apart(const std::vector<bool> &moves);    // by the first particle of a block: whether any of it moves

  const Cutter &cutter;
  const int lanes, particles, many_chunks;
  const bool has_damped;
  bool reordered = false;    // by lay_out_at()
  std::vector<Block> all;
  int active = 0;    // the first blocks, which have work in a pass
  std::vector<Entry> entries;
  std::vector<int> home;               // block of each particle
  std::vector<bool> slowed;            // blocks with friction
  std::vector<int> outside;            // particles of blocks that are held back
  std::vector<int> index, place;       // index of a particle in LAMMPS's arrays, and back
  std::vector<int> ghosts, waiting;    // in our order; `outside` in LAMMPS's
  std::vector<double> total;           // see Pass, in our order
  ImmersedBlocks immersed;
  ExternalForces external;
  int owned = 0;    // number of own particles in LAMMPS's arrays; ghosts come after them
  DistinctRows<double> motions;
  Doubles memory;    // of the arrays
  double *x[3] = {}, *v[3] = {};
  double *seen[3] = {};    // where damped
  Floats rate;             // see Pass
  BlockRanges range;
};

template <class Tell>
void SimdBlocks::tell_motion(const Block &block, Friction friction, const Tell &mover, BlockMotion &to) const
{
  to.row.resize(MOTIONS * lanes);
  to.slow = to.moves = false;
  to.phi = 0.0;
  for (int lane = 0; lane < lanes; ++lane) {
    const int i = lane < block.lanes ? at(block.start + lane) : -1;
    Mover of_lane = i < 0 || is_ghost(i) ? Mover{} : mover(i);
    to.phi = std::max(to.phi, of_lane.phi);
    if (of_lane.in_liquid) of_lane.phi = 0.0;
    to.slow = to.slow || of_lane.phi != 0.0;
    to.moves = to.moves || of_lane.dt != 0.0 || of_lane.in_liquid;
    mdanim::set_motion(of_lane, friction, lanes, lane, to.row.data());
    to.row[FOREIGN_LANE * lanes + lane] = lane < block.lanes ? 0.0 : 1.0;
    to.row[OWNED_LANE * lanes + lane] = i < 0 || is_ghost(i) ? 0.0 : 1.0;
  }
}

// Most runs begin with particles that move as in the last one: to see that takes less than to set it anew.
template <class Tell>
bool SimdBlocks::move_as_before(const Threads &threads, Friction friction, const Tell &mover, double &largest_phi) const
{
  constexpr double NS_OF_LANE = 20.0;
  if (slowed.size() != all.size()) return false;
  std::atomic<bool> same{true};
  std::mutex one_at_a_time;
  threads.parts(static_cast<long>(all.size()), NS_OF_LANE * lanes, [&](long from, long end) {
    BlockMotion now;
    double phi = 0.0;
    for (long n = from; n < end && same; ++n) {
      const Block &block = all[n];
      tell_motion(block, friction, mover, now);
      phi = std::max(phi, now.phi);
      if (now.slow != slowed[n] || (block.bound || now.moves) != (n < active) ||
          !motions.is(block.motion, now.row.data(), now.row.size()))
        same = false;
    }
    const std::lock_guard<std::mutex> lock(one_at_a_time);
    largest_phi = std::max(largest_phi, phi);
  });
  return same;
}

template <class Tell> double SimdBlocks::set_motion(const Threads &threads, Friction friction, const Tell &mover)
{
  double largest_phi = 0.0;
  immersed.forget();
  if (move_as_before(threads, friction, mover, largest_phi)) return largest_phi;
  std::vector<bool> slow(particles), moves(particles);    // by the first particle of a block
  motions = {};
  BlockMotion now;
  for (Block &block : all) {
    tell_motion(block, friction, mover, now);
    largest_phi = std::max(largest_phi, now.phi);
    slow[block.start] = now.slow, moves[block.start] = now.moves;
    block.motion = motions.find_or_add(now.row.data(), now.row.size());
  }
  set_apart(moves);
  slowed.clear();
  for (const Block &block : all) slowed.push_back(slow[block.start]);
  return largest_phi;
}

}    // namespace mdanim
