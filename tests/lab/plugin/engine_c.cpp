// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions over the engine's classes that need no LAMMPS, for tests: cuts, tag order, losses, the displacement budget.

#include "c_api/abi.h"
#include "passes/cutter.h"
#include "passes/displacement_budget.h"
#include "passes/loss.h"
#include "passes/range_cut.h"
#include "passes/strips.h"
#include "passes/tag_order.h"
#include "threads/team.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cfenv>
#include <chrono>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

using namespace mdanim;

namespace {

struct MadeCut {
  Cutter cutter;
  Cut cut;
  RangeCut ranges;
};

std::vector<const double *> rows_of(const double *numbers, int rows)
{
  std::vector<const double *> row(rows);
  for (int i = 0; i < rows; ++i) row[i] = numbers + 3 * i;
  return row;
}

}    // namespace

// Springs from low[s] up to high[s], sorted by low ascending and then by high descending, each of a type of its own, K r0 c.
MDANIM_EXPORT void *mdanim_cut_new(int lanes, int particles, int springs, const int *low, const int *high, const double *krc,
                                   const int *object)
{
  std::vector<SpringCoeffs> coeffs{SpringCoeffs(Spring())};
  SpringRows rows(particles);
  for (int i = 0, s = 0; i < particles; ++i) {
    SpringRows::Row row;
    for (; s < springs && low[s] == i; ++s) {
      row.link.push_back({high[s] - i, static_cast<int>(coeffs.size())});
      coeffs.emplace_back(Spring{krc[3 * s], krc[3 * s + 1], krc[3 * s + 2]});
    }
    rows.add(row);
  }
  rows.close();
  auto *made = new MadeCut;
  made->cutter.start(lanes);
  made->cut = made->cutter.cut({&rows, coeffs.data()}, object);
  return made;
}

// Cuts it into up to so many ranges, and tells how many there are, and crossings and their entries.
MDANIM_EXPORT int mdanim_cut_ranges(void *p, int wanted, int *crossings, int *entries)
{
  auto &[cutter, cut, ranges] = *static_cast<MadeCut *>(p);
  ranges = cut_into_ranges(cutter, cut, wanted);
  *crossings = static_cast<int>(ranges.crossing.size());
  *entries = static_cast<int>(ranges.entry.size());
  return ranges.ranges();
}

// The first particle of each range and the end of the crossings of each border; of each crossing start, end and whether it is
// damped; of each of their entries its offset and push, pull and c of every lane; of each block whether it is at a border, and
// its crossing.
MDANIM_EXPORT void mdanim_ranges_tell(void *p, int *first, int *end_of_border, int *crossing, int *offset, double *coeffs,
                                      int *at_border)
{
  const auto &[cutter, cut, ranges] = *static_cast<MadeCut *>(p);
  std::copy(ranges.first.begin(), ranges.first.end(), first);
  std::copy(ranges.end_of_border.begin(), ranges.end_of_border.end(), end_of_border);
  unsigned e = 0;
  for (const Crossing &c : ranges.crossing) {
    for (const int number : {c.start, static_cast<int>(c.end), static_cast<int>(c.damped)}) *crossing++ = number;
    for (; e < c.end; ++e, coeffs += 3 * cutter.lanes()) {
      *offset++ = ranges.entry[e].offset;
      std::copy_n(cutter.row(c.damped, ranges.entry[e].law), cutter.row_length(c.damped), coeffs);
    }
  }
  for (const Block &b : cut.block) {
    *at_border++ = b.at_border;
    *at_border++ = b.crossing;
  }
}

// How many blocks the strip has that begins with each block, 0 within a strip.
MDANIM_EXPORT void mdanim_strips_tell(void *p, int *strip)
{
  const auto &[cutter, cut, ranges] = *static_cast<MadeCut *>(p);
  std::vector<Block> block = cut.block;
  set_strips(block, cut.entry, cutter.lanes(), ranges);
  for (const Block &b : block) *strip++ = b.strip;
}

// Shares out so many tasks among so many threads, `calls` times: `count` tells how often each task was done. A task takes so many
// microseconds.
MDANIM_EXPORT void mdanim_team_count(int threads, int tasks, int calls, int task_us, int *count)
{
  const std::shared_ptr<Team> team = Team::of(threads);
  struct Work {
    int *count, us;
  } work = {count, task_us};
  for (int n = 0; n < calls; ++n) {
    team->share_out(
        tasks,
        [](void *whose, int task) {
          const auto *of = static_cast<Work *>(whose);
          const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds(of->us);
          while (std::chrono::steady_clock::now() < end) {}
          ++of->count[task];
        },
        &work);
  }
}

// Shares out so many tasks, all of which throw, `calls` times; how many calls threw when all of their tasks had been done.
MDANIM_EXPORT int mdanim_team_throws(int threads, int tasks, int calls)
{
  const std::shared_ptr<Team> team = Team::of(threads);
  int thrown = 0;
  for (int n = 0; n < calls; ++n) {
    std::atomic<int> done{0};
    const auto task = [](void *whose, int which) {
      ++*static_cast<std::atomic<int> *>(whose);
      throw which;
    };
    try {
      team->share_out(tasks, task, &done);
    } catch (int) {
      thrown += done == tasks;
    }
  }
  return thrown;
}

// One call after all others had time to fall asleep, with tasks that leave their processors free. How many threads took tasks,
// and how many tasks did not round as the caller does, upward.
MDANIM_EXPORT void mdanim_team_wakes(int threads, int tasks, int nap_us, int task_us, int *found)
{
  const std::shared_ptr<Team> team = Team::of(threads);
  const auto sleep = [](int us) { std::this_thread::sleep_for(std::chrono::microseconds(us)); };
  team->share_out(tasks, [](void *, int) {}, nullptr);
  sleep(nap_us);
  struct Work {
    int us;
    std::mutex door;
    std::set<std::thread::id> threads;
    int other_mode;
  } work{task_us, {}, {}, 0};
  const int mode = std::fegetround();
  std::fesetround(FE_UPWARD);
  team->share_out(
      tasks,
      [](void *whose, int) {
        auto *of = static_cast<Work *>(whose);
        std::this_thread::sleep_for(std::chrono::microseconds(of->us));
        const std::lock_guard<std::mutex> lock(of->door);
        of->threads.insert(std::this_thread::get_id());
        volatile double one = 1.0, least = 1e-30;
        of->other_mode += one + least == 1.0;
      },
      &work);
  std::fesetround(mode);
  found[0] = static_cast<int>(work.threads.size());
  found[1] = work.other_mode;
}

MDANIM_EXPORT void mdanim_cut_delete(void *made) { delete static_cast<MadeCut *>(made); }

MDANIM_EXPORT int mdanim_cut_blocks(void *made) { return static_cast<int>(static_cast<MadeCut *>(made)->cut.block.size()); }

MDANIM_EXPORT int mdanim_cut_entries(void *made) { return static_cast<int>(static_cast<MadeCut *>(made)->cut.entry.size()); }

// Blocks: start, lanes, end and whether damped, for each; of each entry its offset and push, pull and c of every lane.
MDANIM_EXPORT void mdanim_cut_tell(void *p, int *block, int *offset, double *coeffs)
{
  const auto &[cutter, cut, ranges] = *static_cast<MadeCut *>(p);
  const int lanes = cutter.lanes();
  unsigned e = 0;
  for (const Block &b : cut.block) {
    for (const int number : {b.start, static_cast<int>(b.lanes), static_cast<int>(b.end), static_cast<int>(b.damped)})
      *block++ = number;
    const int width = b.damped ? 3 * lanes : 2 * lanes;
    for (; e < b.end; ++e, coeffs += 3 * lanes) {
      *offset++ = cut.entry[e].offset;
      std::copy_n((b.damped ? cutter.damped_rows() : cutter.rows()) + static_cast<std::size_t>(cut.entry[e].law) * width, width,
                  coeffs);
    }
  }
}

// The line of a rank's own particles, then ghosts; bonds of own ones are partner[first[i]] to partner[first[i + 1] - 1], of
// type 1. Writes their places in the line, and springs as pairs of places in it; returns how many places, in *springs how many
// springs, and -1 when a partner is not known, with its tag in *springs.
MDANIM_EXPORT int mdanim_order(int own, int particles, const int *tag, const int *object, const int *first, const int *partner,
                               int *place, int *pair, int *springs)
{
  std::map<int, int> index;
  for (int i = 0; i < particles; ++i) index.emplace(tag[i], i);
  std::vector<int> bonds(own), type(first[own], 1);
  std::vector<const int *> types(own), partners(own);
  for (int i = 0; i < own; ++i) {
    bonds[i] = first[i + 1] - first[i];
    types[i] = type.data() + first[i];
    partners[i] = partner + first[i];
  }
  struct Lost {
    int tag;
  };
  TagOrder order;
  try {
    order.take({own, tag, object, bonds.data(), types.data(), partners.data(),
                [&](int wanted) {
                  const auto found = index.find(wanted);
                  return found == index.end() ? -1 : found->second;
                },
                [](int, int wanted) { throw Lost{wanted}; }});
  } catch (const Lost &lost) {
    *springs = lost.tag;
    return -1;
  }
  std::copy(order.places().begin(), order.places().end(), place);
  int begin = 0;
  *springs = 0;
  for (const TagOrder::Piece &piece : order.pieces()) {
    for (int i = 0; i < piece.rows.size(); ++i)
      for (const SpringRows::Link &link : piece.rows[i]) {
        *pair++ = begin + i;
        *pair++ = begin + i + link.offset;
        ++*springs;
      }
    begin += piece.rows.size();
  }
  return order.size();
}

// Energy that forces f[n], which see velocities v[n], take in steps of dt, all (steps, particles, 3); the first step is a setup.
// Steps from `first` on to `last` - 1 are taken by passes.
MDANIM_EXPORT double mdanim_loss(int steps, int particles, const double *f, const double *v, double dt, int first, int last)
{
  Loss loss;
  const long size = 3L * particles;
  const auto at = [particles](const double *a, long n, int i) { return vec3(a + 3 * (n * particles + i)); };
  for (int n = 0; n < steps; ++n) {
    if (n == first) loss.close(rows_of(v + n * size, particles).data(), dt);
    if (n >= first && n < last) {
      DashpotSums sums = {0.0, 0.0};
      for (int i = 0; i < particles; ++i) {
        const Vec3 before = n > first ? loss.latest()[i] : Vec3(), now = at(f, n, i), seen = at(v, n, i);
        sums.work -= dot(now + before, seen);
        sums.bend -= dot(now - before, seen - loss.latest_seen()[i]);
        loss.latest()[i] = now;
        loss.latest_seen()[i] = seen;
      }
      loss.passed(sums, dt);
      if (n == last - 1) loss.reopen(dt);
      continue;
    }
    std::vector<Vec3> &force = loss.forces(particles);
    for (int i = 0; i < particles; ++i) force[i] = at(f, n, i);
    loss.step(rows_of(v + n * size, particles).data(), dt, n == 0);
  }
  return loss.total();
}

using Least = void (*)(double *numbers, int count);

// `least` null for a rank that is alone; else `shares` are box_low, box_high, low, high, follows_low, follows_high of each axis.
MDANIM_EXPORT void *mdanim_budget_new(Least least, const double *shares)
{
  auto *budget = new DisplacementBudget;
  if (!least) {
    budget->set_alone();
    return budget;
  }
  std::array<BoxShare, 3> found;
  for (int d = 0; d < 3; ++d, shares += 6)
    found[d] = {shares[0], shares[1], shares[2], shares[3], shares[4] != 0.0, shares[5] != 0.0};
  budget->set_ranks(least);
  budget->set_shares(found);
  return budget;
}

MDANIM_EXPORT void mdanim_budget_delete(void *budget) { delete static_cast<DisplacementBudget *>(budget); }

// Limits, then displacements of particles that are at `now` and were at `then`, both (particles, 3).
MDANIM_EXPORT void mdanim_budget_measure(void *p, double half_skin, double absolute, double relative, int particles,
                                         const double *now, const double *then)
{
  auto &budget = *static_cast<DisplacementBudget *>(p);
  budget.set_limits(half_skin, {absolute, relative});
  budget.measure(particles, [now](int i) { return vec3(now + 3 * i); }, rows_of(then, particles).data());
}

MDANIM_EXPORT int mdanim_budget_spend(void *budget, double way) { return static_cast<DisplacementBudget *>(budget)->spend(way); }

MDANIM_EXPORT void mdanim_budget_begin(void *budget, long build) { static_cast<DisplacementBudget *>(budget)->begin(build); }

// Whether it is nearly spent (1), and overflowed (2).
MDANIM_EXPORT int mdanim_budget_state(void *p)
{
  const auto &budget = *static_cast<DisplacementBudget *>(p);
  return budget.nearly_spent() + 2 * budget.overflowed();
}
