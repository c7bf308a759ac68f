// SPDX-License-Identifier: GPL-2.0-only
// Blocks that a liquid acts on.

#include "passes/pass_liquid.h"
#include "passes/simd_blocks.h"

#include <atomic>

namespace mdanim {

void SimdBlocks::list_immersed(const PassLiquid &liquid)
{
  for (Block &block : all) block.immersed = -1;
  immersed.clear();
  immersed_of.clear();
  immersed_motions = {};
  for (const int i : liquid.near_particles()) all[home[ours(i)]].immersed = 0;
  const auto mover = liquid.immersed();
  std::vector<double> row(IMMERSED_MOTIONS * lanes);
  for (std::size_t b = 0; b < all.size(); ++b) {
    Block &block = all[b];
    if (block.immersed < 0) continue;
    block.immersed = static_cast<int>(immersed.size());
    immersed.push_back(static_cast<int>(b));
    for (int lane = 0; lane < lanes; ++lane) {
      const int i = lane < block.lanes ? at(block.start + lane) : -1;
      const bool is_own = i >= 0 && !is_ghost(i);
      const ImmersedMover of_lane = is_own ? mover(i) : ImmersedMover{};
      const auto put = [&](ImmersedMotion what, double value) { row[what * lanes + lane] = value; };
      put(VOLUME, of_lane.volume);
      put(OWN_MASS, of_lane.mass);
      put(GAMMA, of_lane.gamma);
      put(PER_LENGTH, of_lane.per_length);
      put(LAMBDA, of_lane.lambda);
      put(LISTED, is_own && liquid.is_near(i) ? 1.0 : 0.0);
    }
    immersed_of.push_back(immersed_motions.find_or_add(row.data(), row.size()));
  }
  kept.assign(immersed.size() * KEPT * lanes);
  kept_floats.assign(immersed.size() * KEPT_FLOATS * lanes);
  listed = liquid.listed();
}

// Calls work(kept values of a particle, its row, its lane) for all own particles that the liquid acts on in passes, shared among
// threads. Returns the number of these particles.
template <class Work> long SimdBlocks::each_immersed(const Threads &threads, PassLiquid &liquid, const Work &work) const
{
  constexpr double PARTICLE = 10.0;    // [ns], approximately
  InLiquid *const of = liquid.kept();
  std::atomic<long> particles{0};
  threads.parts(static_cast<long>(immersed.size()), PARTICLE * lanes, [&](long from, long to) {
    long of_part = 0;
    for (long n = from; n < to; ++n) {
      const Block &block = all[immersed[n]];
      if (block.held_back) continue;
      for (int lane = 0; lane < block.lanes; ++lane) {
        const int i = at(block.start + lane);
        if (is_ghost(i)) continue;
        work(of[i], n, lane);
        ++of_part;
      }
    }
    particles += of_part;
  });
  return particles;
}

void SimdBlocks::immerse(const Threads &threads, PassLiquid &liquid, Pass &pass)
{
  if (listed != liquid.listed()) list_immersed(liquid);
  immersed_particles = static_cast<double>(each_immersed(threads, liquid, [this](const InLiquid &of, std::size_t row, int lane) {
    const auto &[base, slope, more, along_x, along_y, flow_x, flow_y, rising] = of.waves;
    const double doubles[KEPT] = {base, slope, of.impulse_x, of.impulse_y};
    const float floats[KEPT_FLOATS] = {more, along_x, along_y, flow_x, flow_y, rising};
    for (int k = 0; k < KEPT; ++k) kept.data()[(row * KEPT + k) * lanes + lane] = doubles[k];
    for (int k = 0; k < KEPT_FLOATS; ++k) kept_floats.data()[(row * KEPT_FLOATS + k) * lanes + lane] = floats[k];
  }));
  pass.kept = kept.data();
  pass.kept_floats = kept_floats.data();
  pass.immersed = immersed_motions.data();
  pass.immersed_of = immersed_of.data();
  pass.liquid = liquid.scales();
  pass.top_of_near = liquid.top_of_near();
}

void SimdBlocks::give_out_impulses(const Threads &threads, PassLiquid &liquid) const
{
  each_immersed(threads, liquid, [this](InLiquid &of, std::size_t row, int lane) {
    of.impulse_x = kept.data()[(row * KEPT + IMPULSE_X) * lanes + lane];
    of.impulse_y = kept.data()[(row * KEPT + IMPULSE_Y) * lanes + lane];
  });
}

}    // namespace mdanim
