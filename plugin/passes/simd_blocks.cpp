// SPDX-License-Identifier: GPL-2.0-only
// Moves particles into blocks and out of them.

#include "passes/simd_blocks.h"

#include "leapfrog/law.h"
#include "passes/strips.h"

#include <algorithm>
#include <utility>

namespace mdanim {

// --- layout ---

static constexpr int PAGE = 512, LINE = 8;    // doubles

SimdBlocks::SimdBlocks(const Cutter &of, Cut &&cut, RangeCut &&ranges)
    : cutter(of), lanes(of.lanes()), particles(cut.particles), many_chunks(cut.chunks), has_damped(of.damped()),
      all(std::move(cut.block)), entries(std::move(cut.entry)), immersed(lanes), external(lanes),
      range(std::move(ranges), (damped() ? 5 : 3) * lanes)
{
  set_strips(all, entries, lanes, range.cut());
  rate.assign(static_cast<std::size_t>(lanes) * number_rates());
  // A processor compares loads with pending stores by their place in a page only. So the places of a particle in all arrays that
  // a thread works on are spread evenly over a page.
  const int kinds = damped() ? 3 : 2, apart = PAGE / (3 * (kinds + 1)) / LINE * LINE;
  std::vector<std::pair<double **, long>> arrays;
  long size = 0;
  const auto add = [&](double *(&of)[3], int kind, int first, int end) {    // with places for particles from `first` to `end`
    for (int d = 0; d < 3; ++d) {
      const long place = (3 * kind + d) * apart + first;
      size += ((place - size) % PAGE + PAGE) % PAGE;
      arrays.emplace_back(&of[d], size - first);
      size += end - first;
    }
  };
  double *(*const of_all[])[3] = {&x, &v, &seen};
  for (int kind = 0; kind < kinds; ++kind) add(*of_all[kind], kind, 0, particles + cut.farthest + 2 * lanes);
  const RangeCut &cuts = range.cut();
  for (int n = 0; n < cuts.ranges(); ++n) {
    const int end = n + 1 < cuts.ranges() ? cuts.first[n + 1] : particles + cut.farthest;
    add(range[n].f, kinds, cuts.first[n] - lanes, end + lanes);
  }
  memory.assign(size);
  for (const auto &[array, place] : arrays) *array = memory.data() + place;
}

SimdBlocks::SimdBlocks(const Cutter &of, Cut &&cut, RangeCut &&ranges, const std::vector<int> &places, int own)
    : SimdBlocks(of, std::move(cut), std::move(ranges))
{ lay_out_at(places, own); }

// Gives all damped entries their rows of Pass::rate; returns how many there are.
unsigned SimdBlocks::number_rates()
{
  unsigned next = 0;
  const auto number = [&next](auto &blocks) {
    unsigned before = 0;
    for (auto &block : blocks) {
      block.rates = next;
      if (block.damped) next += block.end - before;
      before = block.end;
    }
  };
  number(all);
  number(range.crossings());
  return next;
}

// Springs across a border come first: their offsets are the longest.
template <class Visit> void SimdBlocks::each_damped_entry(const Visit &visit) const
{
  const RangeCut &cuts = range.cut();
  unsigned e = 0;
  for (int n = 0, head = 0; n < active; ++n) {
    const Block &block = all[n];
    if (block.strip) head = n;
    if (block.damped && block.crossing >= 0) {
      const Crossing &across = cuts.crossing[block.crossing];
      unsigned k = block.crossing ? cuts.crossing[block.crossing - 1].end : 0;
      for (unsigned row = across.rates; k < across.end; ++k, ++row) visit(cuts.entry[k], block.start, row);
    }
    unsigned row = all[head].rates + (n - head);
    for (; e < block.end; ++e, row += all[head].strip)
      if (block.damped) visit(entries[e], block.start, row);
  }
}

void SimdBlocks::lay_out_at(const std::vector<int> &places, int own)
{
  reordered = true;
  index = places;
  owned = own;
  place.assign(own, -1);
  ghosts.clear();
  for (int i = 0; i < particles; ++i) {
    if (index[i] < own)
      place[index[i]] = i;
    else
      ghosts.push_back(i);
  }
  total.resize(3 * static_cast<std::size_t>(particles));
}

// --- motion ---

void set_motion(const Mover &mover, Friction friction, int lanes, int lane, double *row)
{
  const auto at = [&](Motion what) -> double & { return row[what * lanes + lane]; };
  at(MASS) = mover.pulled;
  at(KICK) = mover.kick;
  at(DT) = mover.dt;
  at(STAY) = at(SHARE) = 1.0;
  at(PUSH) = mover.kick;
  at(BRAKED_MASS) = mover.phi == 0.0 ? 0.0 : mover.mass;
  if (friction == Friction::IMPLICIT) {
    const auto law = Implicit<double>::of(mover.phi, mover.kick);
    at(STAY) = law.stay;
    at(SHARE) = law.share;
    at(PHI) = law.phi;
  } else if (friction == Friction::EXPONENTIAL) {
    const auto law = Exponential<double>::of(mover.phi, mover.kick);
    at(STAY) = law.e;
    at(PUSH) = law.push;
  }
}

// Blocks in which nothing moves or is pulled are put behind all others, where passes do not come.
void SimdBlocks::set_apart(const std::vector<bool> &moves)
{
  const auto order = [](const Block &a, const Block &b) { return a.start < b.start; };
  if (!std::is_sorted(all.begin(), all.end(), order)) std::sort(all.begin(), all.end(), order);
  const auto awake = [&](const Block &block) { return block.bound || moves[block.start]; };
  active = static_cast<int>(std::stable_partition(all.begin(), all.end(), awake) - all.begin());
  home.resize(particles);
  for (std::size_t n = 0; n < all.size(); ++n) std::fill_n(&home[all[n].start], all[n].lanes, static_cast<int>(n));
}

void SimdBlocks::expect(const std::vector<std::vector<int>> &particles_of, const PlaneBlocks::OfProviders &points)
{
  external.expect(particles_of, points, all, [this](int i) -> PlaneBlocks::Lane {
    if (is_ghost(i)) return {-1, 0};
    const int block = home[ours(i)];
    return {block, ours(i) - all[block].start};
  });
}

void SimdBlocks::hold_back(const std::vector<int> &wanted, bool everything)
{
  for (Block &block : all) block.held_back = everything;
  for (const int i : wanted)
    if (!is_ghost(i)) all[home[ours(i)]].held_back = true;
  outside.clear();
  for (const Block &block : all)
    if (block.held_back)
      for (int lane = 0; lane < block.lanes; ++lane)
        if (!is_ghost(at(block.start + lane))) outside.push_back(block.start + lane);
  waiting.clear();
  if (reordered)
    for (const int i : outside) waiting.push_back(index[i]);
}

bool SimdBlocks::friction_acts() const
{
  for (std::size_t b = 0; b < all.size(); ++b)
    if ((slowed[b] || all[b].immersed >= 0) && !all[b].held_back) return true;
  return false;
}

void SimdBlocks::immerse(const Threads &threads, PassLiquid &liquid, const double *lambda, Pass &pass)
{
  if (!immersed.knows(liquid)) {
    for (Block &block : all) block.immersed = -1;
    for (const int i : liquid.near_particles()) all[home[ours(i)]].immersed = 0;
    immersed.list(threads, liquid, lambda, all, own_particle());
  }
  immersed.take_in(threads, liquid, all, own_particle(), pass.immersed);
}

void SimdBlocks::give_out_impulses(const Threads &threads, PassLiquid &liquid) const
{ immersed.give_out(threads, liquid, all, own_particle()); }

void SimdBlocks::take_in(const double *const *from_x, const double *const *from_v)
{
  for (int d = 0; d < 3; ++d) {
    double *to_x = x[d], *to_v = v[d];
    for (int i = 0; i < particles; ++i) {
      const int from = at(i);
      to_x[i] = from_x[from][d];
      to_v[i] = from_v[from][d];
    }
    if (damped()) continue;
    for (const int i : ghosts) to_v[i] = 0.0;
  }
}

void SimdBlocks::give_out(const Threads &threads, double *const *to_x, double *const *to_v) const
{
  threads.parts(particles, PARTICLE, [&](long from, long end) {
    const auto give = [&](const double *const *of, double *const *to) {
      for (int i = static_cast<int>(from); i < end; ++i)
        if (!is_ghost(at(i)))
          for (int d = 0; d < 3; ++d) to[at(i)][d] = of[d][i];
    };
    give(x, to_x);
    give(v, to_v);
  });
}

void SimdBlocks::take_in_held_back(const Threads &threads, const double *const *from_x, const double *const *from_v)
{
  each_outside(threads, [&](int i) {
    for (int d = 0; d < 3; ++d) {
      if (damped()) seen[d][i] = v[d][i];
      x[d][i] = from_x[at(i)][d];
      v[d][i] = from_v[at(i)][d];
    }
  });
}

void SimdBlocks::give_out_held_back(const Threads &threads, double *const *to_x, double *const *to_v) const
{
  each_outside(threads, [&](int i) {
    for (int d = 0; d < 3; ++d) {
      to_x[at(i)][d] = x[d][i];
      to_v[at(i)][d] = v[d][i];
    }
  });
}

// Forces follow from the strain rates: in the last step r_ij was r_ij - dt v_ij. Their sums have the order of all forces.
void SimdBlocks::give_out_dashpots(double dt, std::vector<Vec3> &to_force, std::vector<Vec3> &to_seen) const
{
  std::vector<Vec3> of_lower(particles), of_upper(particles);    // partners
  const auto of = [](const double *const *a, int i) { return Vec3{a[0][i], a[1][i], a[2][i]}; };
  each_damped_entry([&](const Entry &entry, int start, unsigned row) {
    const double *const c = cutter.row(true, entry.law) + 2 * lanes;
    const float *const rates = rate.data() + static_cast<std::size_t>(row) * lanes;
    for (int lane = 0; lane < lanes; ++lane) {
      if (c[lane] == 0.0) continue;
      const int i = start + lane, j = i + entry.offset;
      const Vec3 slowing = (c[lane] * rates[lane]) * ((of(x, i) - of(x, j)) - dt * (of(v, i) - of(v, j)));
      of_upper[i] -= slowing;
      of_lower[j] += slowing;
    }
  });
  for (int i = 0; i < particles; ++i) {
    const int to = at(i);
    if (is_ghost(to)) continue;
    to_force[to] = of_lower[i] + of_upper[i];
    to_seen[to] = of(seen, i);
  }
}

void SimdBlocks::give_out_places(const std::vector<int> &these, double *const *to_x, double *const *to_v) const
{
  for (const int to : these)
    for (int d = 0; d < 3; ++d) {
      to_x[to][d] = x[d][place[to]];
      if (to_v) to_v[to][d] = v[d][place[to]];
    }
}

void SimdBlocks::take_in_ghosts(const double *const *from_x, const double *const *from_v)
{
  for (const int i : ghosts)
    for (int d = 0; d < 3; ++d) {
      x[d][i] = from_x[index[i]][d];
      if (damped()) v[d][i] = from_v[index[i]][d];
    }
}

void SimdBlocks::pack(const std::vector<int> &these, bool velocities, double *to) const
{
  for (const int i : these) {
    for (int d = 0; d < 3; ++d) *to++ = x[d][i];
    for (int d = 0; velocities && d < 3; ++d) *to++ = v[d][i];
  }
}

void SimdBlocks::unpack(const std::vector<int> &these, bool velocities, const double *from)
{
  for (const int i : these) {
    for (int d = 0; d < 3; ++d) x[d][i] = *from++;
    for (int d = 0; velocities && d < 3; ++d, ++from)
      if (damped()) v[d][i] = *from;
  }
}

void SimdBlocks::give_out_forces(double *const *f) const
{
  if (!reordered) return;    // the pass has written them there itself
  for (const int i : outside) std::copy_n(&total[3 * static_cast<std::size_t>(i)], 3, f[index[i]]);
}

void SimdBlocks::fill(Pass &pass, double *const *forces, double dt)
{
  pass.block = all.data();
  pass.entry = entries.data();
  pass.law = cutter.rows();
  pass.damped_law = damped() ? cutter.damped_rows() : nullptr;
  pass.motion = motions.data();
  external.fill(pass, dt);
  for (int d = 0; d < 3; ++d) {
    pass.x[d] = x[d];
    pass.v[d] = v[d];
    pass.seen[d] = seen[d];
  }
  pass.rate = rate.data();
  pass.dt = dt;
  pass.total = reordered ? total.data() : forces[0];
  range.fill(all, active, particles, pass);
}

std::size_t SimdBlocks::bytes() const
{
  return external.bytes() + range.bytes() + all.capacity() * sizeof(Block) + entries.capacity() * sizeof(Entry) +
         motions.bytes() + memory.bytes() + rate.bytes() +
         (home.capacity() + outside.capacity() + index.capacity() + place.capacity() + ghosts.capacity() + waiting.capacity()) *
             sizeof(int) +
         total.capacity() * sizeof(double) + immersed.bytes();
}

}    // namespace mdanim
