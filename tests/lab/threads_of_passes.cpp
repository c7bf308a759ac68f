// SPDX-License-Identifier: GPL-2.0-only
// Passes over damped and plain lattices by one thread and by several, without LAMMPS: a program that tests/sanitize.py compiles
// with the thread sanitizer. Exit code 0: positions, velocities, boxes and sums are the same to the bit.

#include "geometry/boxes.h"
#include "passes/loss.h"
#include "passes/pass_engine.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

using namespace mdanim;

namespace {

constexpr int EDGE = 11, OBJECTS = 3, STEPS = 30, OF_ONE = EDGE * EDGE * EDGE, PARTICLES = OBJECTS * OF_ONE;

// Lattices of EDGE^3 particles with springs along edges and diagonals of faces; the second one is damped.
class Springs final : public PassSprings {
 public:
  Springs()
  {
    law = {SpringCoeffs(Spring{}), SpringCoeffs({50.0, 1.0, 0.0}), SpringCoeffs({25.0, std::sqrt(2.0), 0.0}),
           SpringCoeffs({50.0, 1.0, 0.3}), SpringCoeffs({25.0, std::sqrt(2.0), 0.2})};
    for (int i = 0; i < PARTICLES; ++i) {
      const int damped = i / OF_ONE == 1 ? 2 : 0, n = i % OF_ONE, at[] = {n % EDGE, n / EDGE % EDGE, n / EDGE / EDGE};
      SpringRows::Row row;
      for (int z = 1; z >= 0; --z)
        for (int y = 1; y >= -1; --y)
          for (int x = 1; x >= -1; --x) {
            const int offset = x + EDGE * (y + EDGE * z), edges = std::abs(x) + std::abs(y) + z;
            const bool inside = at[0] + x >= 0 && at[0] + x < EDGE && at[1] + y >= 0 && at[1] + y < EDGE && at[2] + z < EDGE;
            if (offset > 0 && edges < 3 && inside) row.link.push_back({offset, damped + edges});
          }
      rows.add(row);
    }
    rows.close();
  }
  bool halves(HalfBonds &half) const override
  {
    half = {&rows, law.data()};
    return true;
  }
  const std::vector<SpringCoeffs> &coeffs() const override { return law; }
  Loss *account() override { return &loss; }
  long long version() const override { return 1; }
  bool refresh_coefficients() override { return false; }
  void lost_partner(int, int) const override { std::abort(); }
  void took(double) override {}

  Loss loss;

 private:
  SpringRows rows;
  std::vector<SpringCoeffs> law;
};

class Integrator final : public PassIntegrator {
 public:
  Friction friction() const override { return Friction::IMPLICIT; }
  Mover mover(int) override { return {1.0, 1.0, 0.5 * DT, DT, 0.01}; }
  double *trace_rows() override { return trace; }
  bool looks() override { return true; }
  bool tells_of(long long) const override { return true; }
  void finish_step(const std::vector<int> &) override {}
  void begin_step(const std::vector<int> &) override {}
  void moved(double loss, double bend, double, double) override { sums = {loss, bend}; }
  const double *friction_of_particles() const override { return nullptr; }
  std::vector<Known> survey_ghosts(std::vector<int> &) override { return {}; }

  static constexpr double DT = 0.02;
  double trace[OBJECTS * TRACE];
  std::vector<double> sums;
};

// All numbers of a run, one after the other. `mixed`: objects have layers by turns, so that several ranges have particles of
// each.
std::vector<double> film(int threads, bool mixed)
{
  Springs springs;
  Integrator integrator;
  for (int n = 0; n < OBJECTS; ++n) {
    std::fill_n(integrator.trace + TRACE * n, 6, Box::FAR);
    integrator.trace[TRACE * n + FASTEST] = 0.0;
  }
  std::vector<double> numbers(9 * PARTICLES);
  std::vector<double *> row(3 * PARTICLES);
  for (int i = 0; i < 3 * PARTICLES; ++i) row[i] = &numbers[3 * i];
  double *const *const x = row.data(), *const *const v = x + PARTICLES;
  std::vector<int> object(PARTICLES);
  for (int i = 0; i < PARTICLES; ++i) {
    const int n = i % OF_ONE;
    object[i] = 1 + (mixed ? i / (EDGE * EDGE) % OBJECTS : i / OF_ONE);
    const double at[] = {double(n % EDGE), double(n / EDGE % EDGE), double(n / EDGE / EDGE)};
    for (int d = 0; d < 3; ++d) {
      x[i][d] = at[d] + 40.0 * (d == 0 ? i / OF_ONE : 0);
      v[i][d] = std::sin(0.7 * at[(d + 1) % 3] + d);
    }
  }
  springs.loss.forces(PARTICLES);
  springs.loss.step(v, Integrator::DT, true);
  PassEngine engine;
  engine.set_threads(Threads::of_run(threads));
  springs.join(engine.crew);
  integrator.join(engine.crew);
  engine.begin_run(widest_kernels());
  if (!engine.cut(PARTICLES, object.data())) std::abort();
  PassRun &run = engine.start({x, v, v + PARTICLES}, Integrator::DT, true, 0);
  std::vector<double> told;
  for (int n = 0; n < STEPS; ++n) {
    run.step(n, [](bool) {});
    told.insert(told.end(), integrator.sums.begin(), integrator.sums.end());
    told.push_back(run.largest_speed());
  }
  std::printf("%d threads, %d ranges\n", threads, engine.ranges());
  engine.leave();
  told.insert(told.end(), numbers.begin(), numbers.end());
  told.insert(told.end(), integrator.trace, integrator.trace + OBJECTS * TRACE);
  told.push_back(springs.loss.total());
  return told;
}

}    // namespace

int main()
{
  setenv("MDANIM_LEAST_TASK", "15e3", 1);    // 500 particles for each range
  for (const bool mixed : {false, true}) {
    const std::vector<double> alone = film(1, mixed);
    for (const int threads : {2, 4, 5}) {
      const std::vector<double> shared = film(threads, mixed);
      if (shared.size() != alone.size() || std::memcmp(shared.data(), alone.data(), alone.size() * sizeof(double))) {
        std::printf("%d threads give other bits\n", threads);
        return 1;
      }
    }
  }
  return 0;
}
