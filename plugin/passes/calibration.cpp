// SPDX-License-Identifier: GPL-2.0-only
// The measurement: the real pass over a cube and a ball, and calls of a team that sleeps. Others on the machine only lengthen
// times, so the least ones count.

#include "passes/calibration.h"

#include "passes/simd_blocks.h"
#include "threads/team.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

namespace mdanim {

static constexpr double TYPICAL_WAKING = 12e3, TYPICAL_CALLING = 400.0;    // [ns]
// The least that a thread is asked for, in calls: so much the data costs that go from one core to another.
static constexpr double CALLS_OF_TASK = 10.0;

namespace {

using Clock = std::chrono::steady_clock;

double ns_since(Clock::time_point start) { return std::chrono::duration<double, std::nano>(Clock::now() - start).count(); }

// Two bodies that are numbered row by row, with springs to the 18 nearest nodes: a cube, whose rows are equally long, and a ball,
// of whose rows no two are.
struct TimedBodies {
  static constexpr int EDGE = 13, ACROSS = 15;    // particles

  std::vector<std::array<double, 3>> place;
  std::vector<int> object;
  std::vector<std::array<int, 2>> springs;

  TimedBodies()
  {
    constexpr double RADIUS = 0.5 * ACROSS;
    add(EDGE, [](double, double, double) { return true; });
    add(ACROSS, [](double x, double y, double z) { return x * x + y * y + z * z < RADIUS * RADIUS; });
  }

 private:
  template <class Inside> void add(int n, const Inside &inside)
  {
    const double middle = 0.5 * (n - 1);
    std::vector<int> number(static_cast<std::size_t>(n) * n * n, -1);
    const auto at = [&](int x, int y, int z) -> int & { return number[(static_cast<std::size_t>(z) * n + y) * n + x]; };
    const int first = static_cast<int>(place.size()), kind = object.empty() ? 1 : object.back() + 1;
    const auto each = [&](const auto &f) {
      for (int z = 0; z < n; ++z)
        for (int y = 0; y < n; ++y)
          for (int x = 0; x < n; ++x) f(x, y, z);
    };
    each([&](int x, int y, int z) {
      if (!inside(x - middle, y - middle, z - middle)) return;
      at(x, y, z) = static_cast<int>(place.size());
      place.push_back({x + 100.0 * kind, 1.0 * y, 1.0 * z});
      object.push_back(kind);
    });
    static constexpr int TO[][3] = {{0, 1, 1}, {1, 0, 1}, {0, 0, 1},  {-1, 0, 1}, {0, -1, 1},
                                    {1, 1, 0}, {0, 1, 0}, {-1, 1, 0}, {1, 0, 0}};
    each([&](int x, int y, int z) {
      if (at(x, y, z) < first) return;
      for (const auto &d : TO) {    // offsets descending
        const int to[] = {x + d[0], y + d[1], z + d[2]};
        if (std::any_of(to, to + 3, [n](int t) { return t < 0 || t >= n; }) || at(to[0], to[1], to[2]) < 0) continue;
        springs.push_back({at(x, y, z), at(to[0], to[1], to[2])});
      }
    });
  }
};

// These bodies in a pass with one set of instructions, with drag, at rest: time does not depend on how they move.
class TimedPass {
 public:
  TimedPass(const TimedBodies &bodies, const Kernels &kernels, bool damped) : kernels(kernels), particles(bodies.place.size())
  {
    constexpr double STEP = 0.1, PHI = 1e-6, DASHPOT = 0.01;
    const std::vector<SpringCoeffs> law{SpringCoeffs(Spring()), SpringCoeffs({0.5, 1.0, damped ? DASHPOT : 0.0}),
                                        SpringCoeffs({0.5, std::sqrt(2.0), damped ? DASHPOT : 0.0})};
    SpringRows rows(static_cast<int>(particles));
    std::size_t s = 0;
    for (std::size_t i = 0; i < particles; ++i) {
      SpringRows::Row row;
      for (; s < bodies.springs.size() && bodies.springs[s][0] == static_cast<int>(i); ++s) {
        const auto &a = bodies.place[i], &b = bodies.place[bodies.springs[s][1]];
        const double square = (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]);
        row.link.push_back({bodies.springs[s][1] - static_cast<int>(i), square < 1.5 ? 1 : 2});
      }
      rows.add(row);
    }
    rows.close();
    cutter.start(kernels.lanes);
    Cut all = cutter.cut({&rows, law.data()}, bodies.object.data());
    RangeCut one = cut_into_ranges(cutter, all, 1);
    blocks.emplace(cutter, std::move(all), std::move(one));
    blocks->set_motion(Friction::IMPLICIT, [](int) { return Mover{1.0, 1.0, 0.5 * STEP, STEP, PHI, false}; });
    double still[3] = {};
    std::vector<const double *> x, v(particles, still);
    for (const auto &place : bodies.place) x.push_back(place.data());
    blocks->take_in(x.data(), v.data());
    if (damped) blocks->take_in_dashpots(std::vector<Vec3>(particles), std::vector<Vec3>(particles));
    blocks->expect({});
    blocks->hold_back({}, false);
    double *none = nullptr;
    blocks->fill(pass, &none);
    pass.friction = Friction::IMPLICIT;
    sums.resize(blocks->chunks());
    pass.sums = sums.data();
  }

  // A few passes, of which the first ones meet the caches and the mode of the processor that others have left.
  void run()
  {
    constexpr int PASSES = 5, WARM = 2;
    for (int n = 0; n < PASSES; ++n) {
      const Clock::time_point start = Clock::now();
      blocks->begin_pass(pass);
      pass.range = blocks->ranges().data();
      kernels.pass(pass);
      if (n >= WARM) least = std::min(least, ns_since(start));
    }
  }
  double ns() const { return least / static_cast<double>(particles); }

 private:
  const Kernels &kernels;
  const std::size_t particles;
  Cutter cutter;
  std::optional<SimdBlocks> blocks;
  Pass pass = {};
  std::vector<PassSums> sums;
  double least = std::numeric_limits<double>::max();
};

// Two tasks that keep a processor each for so many ns, after a nap of both threads: what the call takes beyond that. Where the
// other thread gets no processor in time the caller does both, which says nothing of how long it takes to come: 0 if that is
// always so. Of all other calls the quickest fourth counts.
double measure_call(int calls, double task, std::chrono::microseconds nap)
{
  const Threads two(2);
  std::vector<double> found;
  for (int n = 0; n < calls; ++n) {
    if (nap.count()) std::this_thread::sleep_for(nap);
    const Clock::time_point start = Clock::now();
    two.each(2, 2.0 * task, [task](int) {
      for (const Clock::time_point began = Clock::now(); ns_since(began) < task;) {}
    });
    const double longer = ns_since(start) - task;
    if (longer < task) found.push_back(longer);
  }
  if (found.empty()) return 0.0;
  const auto quartile = found.begin() + static_cast<long>(found.size() / 4);
  std::nth_element(found.begin(), quartile, found.end());
  return *quartile;
}

std::mutex one_at_a_time;
std::optional<Calibration> known;

}    // namespace

const Calibration::Width &Calibration::fastest(bool damped) const
{
  return *std::min_element(widths.begin(), widths.end(),
                           [damped](const Width &a, const Width &b) { return of(a, damped) < of(b, damped); });
}

Calibration measure_calibration()
{
  constexpr int ROUNDS = 5;
  const TimedBodies bodies;
  std::vector<std::unique_ptr<TimedPass>> samples;
  using std::chrono::microseconds;
  Calibration found{{}, measure_call(40, 60e3, microseconds(150)), measure_call(200, 3e3, microseconds(0))};
  for (const Kernels *kernels : kernels_here()) {
    found.widths.push_back({kernels, 0.0, 0.0});
    for (const bool damped : {false, true}) samples.push_back(std::make_unique<TimedPass>(bodies, *kernels, damped));
  }
  for (int n = 0; n < ROUNDS; ++n)
    for (const auto &sample : samples) sample->run();
  for (std::size_t n = 0; n < found.widths.size(); ++n) {
    found.widths[n].springs = samples[2 * n]->ns();
    found.widths[n].dashpots = samples[2 * n + 1]->ns();
  }
  return found;
}

const Calibration &calibration()
{
  const std::lock_guard<std::mutex> lock(one_at_a_time);
  if (!known) known = measure_calibration();
  return *known;
}

void give_calibration(Calibration now)
{
  const std::lock_guard<std::mutex> lock(one_at_a_time);
  known = std::move(now);
}

Threads threads_here(int many)
{
  if (many < 2) return Threads();
  const double waking = calibration().waking, calling = calibration().calling;
  return Threads(many, CALLS_OF_TASK * (calling > 0.0 ? calling : TYPICAL_CALLING), waking > 0.0 ? waking : TYPICAL_WAKING);
}

double ns_of_pass(int particles, const Kernels &kernels, bool damped)
{
  const std::vector<Calibration::Width> &widths = calibration().widths;
  const auto own = std::find_if(widths.begin(), widths.end(), [&](const auto &width) { return width.kernels == &kernels; });
  return particles * Calibration::of(*own, damped);
}

}    // namespace mdanim
