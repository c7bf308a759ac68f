// SPDX-License-Identifier: GPL-2.0-only
// The blocks that a liquid acts on, and what is kept for their particles.

#pragma once

#include "geometry/aligned_array.h"
#include "passes/pass.h"
#include "passes/pass_liquid.h"
#include "springs/distinct_rows.h"
#include "threads/team.h"

#include <atomic>
#include <vector>

namespace mdanim {

// In all functions own(place) is the index in LAMMPS's arrays of the particle at a place, -1 for a ghost.
class ImmersedBlocks {
 public:
  explicit ImmersedBlocks(int lanes) : lanes(lanes) {}

  void forget() { listed = -1; }    // coefficients of particles have changed
  bool knows(const PassLiquid &liquid) const { return listed == liquid.listed(); }
  // Lists the blocks whose `immersed` is not negative.
  template <class Own>
  void list(const Threads &threads, const PassLiquid &liquid, const double *lambda, std::vector<Block> &all, const Own &own);
  // Takes in what is kept for particles; blocks that are held back are left out.
  template <class Own>
  void take_in(const Threads &threads, PassLiquid &liquid, std::vector<Block> &all, const Own &own, ImmersedRows &rows);
  // Where nothing is kept: the parts of particles below the surface in this step, at their places.
  void look_up(const Threads &threads, const PassLiquid &liquid, const std::vector<Block> &all, const double *const *x);
  // Gives the impulses of particles on the liquid back.
  template <class Own>
  void give_out(const Threads &threads, PassLiquid &liquid, const std::vector<Block> &all, const Own &own) const;

  double particles() const { return particles_in; }    // of blocks that are not held back, and in the liquid
  std::size_t bytes() const
  {
    return kept.bytes() + small.bytes() + coefficients.bytes() + coefficients_of.capacity() * sizeof(unsigned) +
           blocks.capacity() * sizeof(int);
  }

 private:
  // Calls work(number, block) for all blocks that are not held back, shared among threads.
  template <class All, class Work> void each_block(const Threads &threads, All &all, const Work &work) const
  {
    threads.parts(static_cast<long>(blocks.size()), PARTICLE * lanes, [&](long from, long to) {
      for (long n = from; n < to; ++n)
        if (auto &block = all[blocks[n]]; !block.held_back) work(n, block);
    });
  }
  // Calls work(particle, lane) for the own particles of a block.
  template <class Own, class Work> static void each_lane(const Block &block, const Own &own, const Work &work)
  {
    for (int lane = 0; lane < block.lanes; ++lane)
      if (const int i = own(block.start + lane); i >= 0) work(i, lane);
  }
  template <class Array> auto *number_at(Array &array, long block, int numbers, int number, int lane) const
  { return array.data() + (block * numbers + number) * lanes + lane; }

  static constexpr double PARTICLE = 10.0;    // time for one [ns], approximately

  const int lanes;
  long long listed = -1;      // by the liquid
  std::vector<int> blocks;    // with particles near the liquid
  double particles_in = 0.0;
  Doubles kept;    // see ImmersedRows
  Floats small;
  DistinctRows<double> coefficients;
  std::vector<unsigned> coefficients_of;
};

// Most runs list what the last one has listed.
template <class Own>
void ImmersedBlocks::list(const Threads &threads, const PassLiquid &liquid, const double *lambda, std::vector<Block> &all,
                          const Own &own)
{
  std::vector<int> now;
  for (std::size_t b = 0; b < all.size(); ++b) {
    if (all[b].immersed < 0) continue;
    all[b].immersed = static_cast<int>(now.size());
    now.push_back(static_cast<int>(b));
  }
  const std::size_t length = static_cast<std::size_t>(PARTICLE_NUMBERS) * lanes;
  const auto tell = [&, mover = liquid.immersed(lambda)](const Block &block, std::vector<double> &row) {
    for (int lane = 0; lane < lanes; ++lane) {
      const int i = lane < block.lanes ? own(block.start + lane) : -1;
      const Immersed<double> of_lane = i >= 0 ? mover(i) : Immersed<double>{};
      for (int k = 0; k < PARTICLE_NUMBERS; ++k) row[k * lanes + lane] = of_lane.of[k];
    }
  };
  std::atomic<bool> same{now == blocks};
  blocks.swap(now);
  threads.parts(static_cast<long>(blocks.size()), PARTICLE * lanes, [&](long from, long end) {
    std::vector<double> row(length);
    for (long n = from; n < end && same; ++n) {
      tell(all[blocks[n]], row);
      if (!coefficients.is(coefficients_of[n], row.data(), length)) same = false;
    }
  });
  if (!same) {
    coefficients_of.clear();
    coefficients = {};
    std::vector<double> row(length);
    for (const int b : blocks) {
      tell(all[b], row);
      coefficients_of.push_back(coefficients.find_or_add(row.data(), length));
    }
  }
  kept.assign(blocks.size() * KEPT_NUMBERS * lanes);
  small.assign(blocks.size() * SMALL_NUMBERS * lanes);
  listed = liquid.listed();
}

template <class Own>
void ImmersedBlocks::take_in(const Threads &threads, PassLiquid &liquid, std::vector<Block> &all, const Own &own,
                             ImmersedRows &rows)
{
  const InLiquid *const of_all = liquid.kept();
  std::atomic<long> many{0};
  each_block(threads, all, [&](long n, Block &block) {
    block.only_lifted = of_all;
    if (of_all) each_lane(block, own, [&](int i, int) { block.only_lifted = block.only_lifted && of_all[i].waves.only_lifts(); });
    if (!block.only_lifted) many += block.lanes;
    if (of_all)
      each_lane(block, own, [&](int i, int lane) {
        const InLiquid &of = of_all[i];
        const auto put = [&](int number, double value) { *number_at(kept, n, KEPT_NUMBERS, number, lane) = value; };
        const auto put_small = [&](int k) { *number_at(small, n, SMALL_NUMBERS, k, lane) = of.waves.small[k]; };
        if (block.only_lifted) return put_small(MORE);
        for (int k = 0; k < EXACT_NUMBERS; ++k) put(k, of.waves.exact[k]);
        for (int k = 0; k < SMALL_NUMBERS; ++k) put_small(k);
        put(IMPULSE_X, of.impulse_x);
        put(IMPULSE_Y, of.impulse_y);
      });
  });
  particles_in = static_cast<double>(many);
  rows = {kept.data(), small.data(), coefficients.data(), coefficients_of.data(), liquid.scales(), liquid.top_of_near()};
}

inline void ImmersedBlocks::look_up(const Threads &threads, const PassLiquid &liquid, const std::vector<Block> &all,
                                    const double *const *x)
{
  each_block(threads, all, [&](long n, const Block &block) {
    liquid.parts_below(x, block.start, block.lanes, number_at(kept, n, KEPT_NUMBERS, BASE, 0));
  });
}

template <class Own>
void ImmersedBlocks::give_out(const Threads &threads, PassLiquid &liquid, const std::vector<Block> &all, const Own &own) const
{
  InLiquid *const of = liquid.kept();
  if (!of) return;
  each_block(threads, all, [&](long n, const Block &block) {
    if (block.only_lifted) return;    // pushes the liquid by nothing
    each_lane(block, own, [&](int i, int lane) {
      of[i].impulse_x = *number_at(kept, n, KEPT_NUMBERS, IMPULSE_X, lane);
      of[i].impulse_y = *number_at(kept, n, KEPT_NUMBERS, IMPULSE_Y, lane);
    });
  });
}

}    // namespace mdanim
