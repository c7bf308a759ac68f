// SPDX-License-Identifier: GPL-2.0-only
// Cutting particles into blocks, and moving them in and out.

#include "engine/simd_blocks.h"

#include "engine/hash.h"
#include "laws/leapfrog.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace mdanim {

// What a block costs besides its springs, in vectors of springs.
static constexpr int OVERHEAD = 2;
// Cut only when at least this part of the lanes has work.
static constexpr double WORTH_IT = 0.3;
// Arrays that start at the same place of a page get in each other's way in the caches; they start so many doubles apart.
static constexpr int STAGGER = 72;

// --- storage ---

void Catalogue::start(int numbers)
{
  width = numbers;
  count = latest = 0;
  rows.clear();
  known.clear();
}

unsigned Catalogue::find_or_add(const double *row)
{
  const std::size_t size = width * sizeof(double);
  const auto is = [&](unsigned n) { return std::memcmp(rows.data() + static_cast<std::size_t>(n) * width, row, size) == 0; };
  if (count && is(latest)) return latest;
  std::uint64_t hash = HASH_OF_NOTHING;
  for (int k = 0; k < width; ++k) {
    std::uint64_t word;
    std::memcpy(&word, row + k, sizeof word);
    hash = hash_with(hash, word);
  }
  const auto [begin, end] = known.equal_range(hash);
  for (auto it = begin; it != end; ++it)
    if (is(it->second)) return latest = it->second;
  known.emplace(hash, count);
  rows.push(row, width);
  return latest = count++;
}

// --- cutting ---

// How many particles the best cut takes into the block that ends before particle i; index 1 … N.
std::vector<int> SimdBlocks::lengths(const HalfBonds &bonds, const int *object) const
{
  const SpringRows &rows = *bonds.rows;
  const int particles = rows.size();
  std::vector<int> best(particles + 1);
  int farthest = 0;
  for (int i = 0; i < particles; ++i)
    for (const SpringRows::Link &link : rows[i]) farthest = std::max(farthest, link.offset);
  std::vector<int> seen(farthest + 1, -1);    // first particle of the latest block that has this offset
  std::vector<long> cost(particles + 1, std::numeric_limits<long>::max());
  cost[0] = 0;
  for (int i = 0; i < particles; ++i) {
    long offsets = 0;
    for (int n = 1; n <= lanes && i + n <= particles; ++n) {
      const int k = i + n - 1;
      if (object[k] != object[i]) break;
      for (const SpringRows::Link &link : rows[k]) {
        int &latest = seen[link.offset];
        offsets += latest != i;
        latest = i;
      }
      const long total = cost[i] + OVERHEAD + offsets;
      if (total <= cost[i + n]) {    // of equal ones the longer, which comes later
        cost[i + n] = total;
        best[i + n] = n;
      }
    }
  }
  return best;
}

void SimdBlocks::start(int lanes_of_blocks)
{
  lanes = lanes_of_blocks;
  laws.start(2 * lanes);
  damped_laws.start(3 * lanes);
  usual_laws = 0;
  put_together({});
}

Cut SimdBlocks::cut(const HalfBonds &bonds, const int *object)
{
  const SpringRows &rows = *bonds.rows;
  Cut cut;
  cut.particles = rows.size();
  cut.springs = rows.total();
  const std::vector<int> length = lengths(bonds, object);
  for (int end = cut.particles; end > 0; end -= length[end])
    cut.block.push_back({end - length[end], static_cast<short>(length[end]), false, false, false, 0, -1, 0, object[end - 1] - 1});
  std::reverse(cut.block.begin(), cut.block.end());

  std::vector<bool> damped(cut.particles), bound(cut.particles);
  for (int i = 0; i < cut.particles; ++i)
    for (const SpringRows::Link &link : rows[i]) {
      bound[i] = bound[i + link.offset] = true;
      if (bonds.law[link.type].c > 0.0) damped[i] = damped[i + link.offset] = true;
    }

  std::vector<SpringRows::Links> left(lanes);    // springs of each lane
  std::vector<double> law(3 * lanes);
  for (Block &block : cut.block) {
    for (int lane = 0; lane < block.lanes; ++lane) {
      left[lane] = rows[block.start + lane];
      block.damped = block.damped || damped[block.start + lane];
      block.bound = block.bound || bound[block.start + lane];
    }
    for (;;) {
      int offset = 0;    // the longest that is left
      for (int lane = 0; lane < block.lanes; ++lane)
        if (left[lane].size()) offset = std::max(offset, left[lane].first->offset);
      if (offset == 0) break;
      std::fill(law.begin(), law.end(), 0.0);
      for (int lane = 0; lane < block.lanes; ++lane) {
        auto &[link, last] = left[lane];
        if (link == last || link->offset != offset) continue;
        const SpringCoeffs &own = bonds.law[link++->type];    // a second spring between the same two is another entry
        law[lane] = own.push;
        law[lanes + lane] = own.pull;
        if (block.damped) law[2 * lanes + lane] = own.c;
      }
      cut.entry.push_back({offset, (block.damped ? damped_laws : laws).find_or_add(law.data())});
      cut.farthest = std::max(cut.farthest, offset);
    }
    block.end = static_cast<unsigned>(cut.entry.size());
  }
  return cut;
}

bool LaneUse::worth_it() const { return lanes > 0.0 && springs >= WORTH_IT * lanes; }

LaneUse SimdBlocks::put_together(const std::vector<const Cut *> &cuts)
{
  all.clear();
  entries.clear();
  has_room = false;
  particles = farthest = 0;
  std::size_t springs = 0;
  for (const Cut *cut : cuts) {
    const unsigned first = static_cast<unsigned>(entries.size());
    for (Block block : cut->block) {
      block.start += particles;
      block.end += first;
      all.push_back(block);
    }
    entries.insert(entries.end(), cut->entry.begin(), cut->entry.end());
    particles += cut->particles;
    springs += cut->springs;
    farthest = std::max(farthest, cut->farthest);
  }
  if (!usual_laws) usual_laws = laws.size() + damped_laws.size();
  return {static_cast<double>(springs), static_cast<double>(entries.size() * lanes)};
}

void SimdBlocks::make_room()
{
  if (has_room) return;
  has_room = true;
  const std::size_t room = (particles + farthest + 2 * lanes) / 512 * 512 + 512 + STAGGER;    // whole pages and a bit
  const int kinds = damped() ? 6 : 3;
  memory.assign(3 * kinds * room);
  double *place = memory.data();
  double **const arrays[] = {x, v, f, part, last, seen};
  for (int kind = 0; kind < kinds; ++kind)
    for (int d = 0; d < 3; ++d, place += room) arrays[kind][d] = place;
  outside.clear();
}

void SimdBlocks::lay_out()
{
  make_room();
  reordered = false;
  index.clear();
  ghosts.clear();
}

bool SimdBlocks::laws_pile_up() const
{
  constexpr unsigned MANY = 4;    // times as many as usual
  return laws.size() + damped_laws.size() > MANY * (usual_laws + 64);
}

void SimdBlocks::lay_out_at(const std::vector<int> &places, int own)
{
  make_room();
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

void SimdBlocks::set_row(const Mover &mover, Friction friction, int lane, double *row) const
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

// Blocks in which nothing moves or is pulled come behind all others, where passes do not get to.
void SimdBlocks::set_apart(const std::vector<bool> &moves)
{
  const auto order = [](const Block &a, const Block &b) { return a.start < b.start; };
  if (!std::is_sorted(all.begin(), all.end(), order)) std::sort(all.begin(), all.end(), order);
  const auto awake = [&](const Block &block) { return block.bound || moves[block.start]; };
  active = static_cast<int>(std::stable_partition(all.begin(), all.end(), awake) - all.begin());
  home.resize(particles);
  for (std::size_t n = 0; n < all.size(); ++n) std::fill_n(&home[all[n].start], all[n].lanes, static_cast<int>(n));
}

// Blocks with a particle of anybody have a row for everybody.
void SimdBlocks::expect(const std::vector<std::vector<int>> &particles_of)
{
  const int many = static_cast<int>(particles_of.size());
  for (Block &block : all) block.external_force = -1;
  force_providers.assign(many, {});
  int rows = 1;    // the first is for forces on ghosts
  for (int n = 0; n < many; ++n)
    for (const int i : particles_of[n]) {
      ForceProvider &provider = force_providers[n];
      const int to = static_cast<int>(provider.slot.size());
      if (is_ghost(i)) {
        provider.ghosts.push_back({i, to});
        provider.particle.push_back(0);
        provider.slot.push_back(0);
        continue;
      }
      provider.particle.push_back(ours(i));
      Block &block = all[home[ours(i)]];
      if (block.external_force < 0) {
        block.external_force = rows;
        rows += many;
      }
      const long row = block.external_force + n;
      provider.slot.push_back(row * 3 * lanes + ours(i) - block.start);
    }
  external_force.assign(static_cast<std::size_t>(rows) * 3 * lanes);
}

void SimdBlocks::tell_places(std::size_t n, const double *const *of_ghosts, Positions &to) const
{
  const std::vector<int> &particle = force_providers[n].particle;
  to.make_room(particle.size());
  for (int d = 0; d < 3; ++d) {
    double *next = to.along[d].data();
    for (const int i : particle) *next++ = x[d][i];
  }
  for (const auto &[i, place] : force_providers[n].ghosts) to.put(place, of_ghosts[i]);
}

void SimdBlocks::clear_external_force() { std::fill_n(external_force.data(), external_force.size(), 0.0); }

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
    if (slowed[b] && !all[b].held_back) return true;
  return false;
}

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

void SimdBlocks::give_out(double *const *to_x, double *const *to_v) const
{
  const auto give = [this](const double *const *from, double *const *to) {
    for (int i = 0; i < particles; ++i)
      if (!is_ghost(at(i)))
        for (int d = 0; d < 3; ++d) to[at(i)][d] = from[d][i];
  };
  if (to_x) give(x, to_x);
  if (to_v) give(v, to_v);
}

void SimdBlocks::take_in_held_back(const double *const *from_x, const double *const *from_v)
{
  for (const int i : outside)
    for (int d = 0; d < 3; ++d) {
      x[d][i] = from_x[at(i)][d];
      v[d][i] = from_v[at(i)][d];
    }
}

void SimdBlocks::give_out_held_back(double *const *to_x, double *const *to_v) const
{
  for (const int i : outside)
    for (int d = 0; d < 3; ++d) {
      to_x[at(i)][d] = x[d][i];
      to_v[at(i)][d] = v[d][i];
    }
}

void SimdBlocks::take_in_dashpots(const std::vector<Vec3> &from_force, const std::vector<Vec3> &from_seen)
{
  const auto put = [](const Vec3 &from, double *const *to, int i) { to[0][i] = from.x, to[1][i] = from.y, to[2][i] = from.z; };
  for (int i = 0; i < particles; ++i) {
    const int from = at(i);
    if (is_ghost(from)) continue;
    put(from_force[from], last, i);
    put(from_seen[from], seen, i);
  }
}

void SimdBlocks::give_out_dashpots(std::vector<Vec3> &to_force, std::vector<Vec3> &to_seen) const
{
  for (int i = 0; i < particles; ++i) {
    const int to = at(i);
    if (is_ghost(to)) continue;
    to_force[to] = {last[0][i], last[1][i], last[2][i]};
    to_seen[to] = {seen[0][i], seen[1][i], seen[2][i]};
  }
}

void SimdBlocks::count_held_back(const double *const *from_v, DashpotSums &sums)
{
  for (const int i : outside) {
    if (!all[home[i]].damped) continue;
    const auto of = [i](const double *const *a) { return Vec3{a[0][i], a[1][i], a[2][i]}; };
    const auto terms = dashpot_work(of(part), of(last), of(seen), of(v), vec3(from_v[at(i)]));
    sums.work += terms.work;
    sums.bend += terms.bend;
    sums.ahead += terms.ahead;
    for (int d = 0; d < 3; ++d) {
      last[d][i] = part[d][i];
      seen[d][i] = v[d][i];
      part[d][i] = 0.0;
    }
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

void SimdBlocks::fill(Pass &pass, double *const *forces)
{
  pass.block = all.data();
  pass.blocks = active;
  pass.entry = entries.data();
  pass.law = laws.data();
  pass.damped_law = damped() ? damped_laws.data() : nullptr;
  pass.motion = motions.data();
  pass.external_force = external_force.data();
  pass.force_providers = static_cast<int>(force_providers.size());
  for (int d = 0; d < 3; ++d) {
    pass.x[d] = x[d];
    pass.v[d] = v[d];
    pass.f[d] = f[d];
    pass.part[d] = part[d];
    pass.last[d] = last[d];
    pass.seen[d] = seen[d];
  }
  pass.total = reordered ? total.data() : forces[0];
}

std::size_t SimdBlocks::bytes() const
{
  std::size_t of_providers = external_force.bytes();
  for (const ForceProvider &b : force_providers)
    of_providers += b.particle.capacity() * sizeof(int) + b.ghosts.capacity() * sizeof(Ghost) + b.slot.capacity() * sizeof(long);
  return of_providers + all.capacity() * sizeof(Block) + entries.capacity() * sizeof(Entry) + laws.bytes() + damped_laws.bytes() +
         motions.bytes() + memory.bytes() +
         (home.capacity() + outside.capacity() + index.capacity() + place.capacity() + ghosts.capacity() + waiting.capacity()) *
             sizeof(int) +
         total.capacity() * sizeof(double);
}

}    // namespace mdanim
