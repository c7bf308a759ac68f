// SPDX-License-Identifier: GPL-2.0-only
// Energy that velocity-dependent forces take during a run.

#pragma once

#include "numbers/vec3.h"
#include "passes/pass.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace mdanim {

// Such a force F^n is computed with v^{n-1/2} and acts from there to v^{n+1/2}: what it takes in the step is exactly
//   W^n = -dt F^n . (v^{n-1/2} + v^{n+1/2}) / 2.
// So the forces of a step are kept for each particle, and the next computation, which sees v^{n+1/2}, closes their account.
// The energy that leap-frog conserves to fourth order (fix_mdanim_leapfrog.cpp) is that of a smooth path through the x^n, whose
// velocity is not v^n but v^n - dt^2/6 da/dt. What F takes on that path up to step n, the ends of the sum by Euler and Maclaurin,
// is
//   sum_{m<n} [W^m - dt/6 (F^{m+1} - F^m) . (v^{m+1/2} - v^{m-1/2})]
//     - dt/2 F^n . v^{n-1/2} + dt/12 (F^n - F^{n-1}) . v^{n-1/2}.
// The forces of a setup see v^n itself, and count for half a step.
class Loss {
 public:
  // Called when lists are rebuilt: checks whether particle i is still the one whose force was kept.
  template <class Tag> void look(const Tag *tag, int particles)
  {
    if (static_cast<int>(order.size()) == particles && std::equal(order.begin(), order.end(), tag)) return;
    order.assign(tag, tag + particles);
    reordered = true;
  }

  // Room for the forces of a computation, all zero.
  std::vector<Vec3> &forces(int particles)
  {
    last.swap(force);
    force.assign(particles, Vec3());
    return force;
  }

  // Closes a step when the forces are complete. v is the velocity that they were computed with.
  void step(const double *const *v, double dt, bool setup)
  {
    const int particles = static_cast<int>(force.size());
    if (reordered) known = false;
    reordered = false;
    const double now = -sum_of(force, v);
    // Where particles were re-ordered, F^n . v^{n+1/2} is taken for the mean of F^n . v^{n-1/2} and F^{n+1} . v^{n+1/2}, and the
    // bend for that of the last step.
    if (setup)
      sum += tail;
    else if (begun)
      sum += 0.5 * dt * power;
    else
      sum += 0.5 * dt * (power + (known ? -sum_of(last, v) : 0.5 * (power + now)));
    double change = 0.0;
    if (setup) bend = 0.0;
    if (!setup && known) {
      bend = 0.0;
      for (int i = 0; i < particles; ++i) {
        const Vec3 more = force[i] - last[i];
        bend -= dot(more, vec3(v[i]) - seen[i]);
        change += dot(more, vec3(v[i]));
      }
    }
    sum += dt / 6.0 * bend;
    power = now;
    tail = setup ? 0.0 : 0.5 * dt * power + dt / 12.0 * change;
    begun = setup;
    known = !setup;
    seen.resize(particles);
    for (int i = 0; i < particles; ++i) seen[i] = vec3(v[i]);
  }

  // For steps that passes take, which sum the same spring by spring (springs/dashpot_work.h). Before these steps the account so
  // far is closed; v is the velocity of the next forces.
  void close(const double *const *v, double dt)
  {
    sum += 0.5 * dt * (begun ? power : power - sum_of(force, v));
    tail = 0.0;
    closed = true;
  }
  // Adds one such step. The first pass knows nothing of the step before: its bend is that of the last step.
  void passed(const DashpotSums &sums, double dt)
  {
    if (!closed) bend = sums.bend;
    closed = false;
    sum += 0.5 * dt * sums.work + dt / 6.0 * bend;
  }
  // Called after them: F^{n-1} and v^{n-3/2} are back in latest() and latest_seen(), as after a plain step.
  void reopen(double dt)
  {
    power = 0.0;
    for (std::size_t i = 0; i < force.size(); ++i) power -= dot(force[i], seen[i]);
    tail = 0.5 * dt * power;
    sum -= tail;
    begun = false;
    known = true;
  }
  std::vector<Vec3> &latest() { return force; }
  std::vector<Vec3> &latest_seen() { return seen; }

  // Energy lost up to the last step.
  double total() const { return sum + tail; }
  std::size_t bytes() const
  { return (force.capacity() + last.capacity() + seen.capacity()) * sizeof(Vec3) + order.capacity() * sizeof(long long); }

 private:
  static double sum_of(const std::vector<Vec3> &f, const double *const *v)
  {
    double all = 0.0;
    for (std::size_t i = 0; i < f.size(); ++i) all += dot(f[i], vec3(v[i]));
    return all;
  }

  std::vector<Vec3> force, last;    // F^n, F^{n-1} of the particles here
  std::vector<Vec3> seen;           // v^{n-1/2}
  std::vector<long long> order;     // tags
  double sum = 0.0, tail = 0.0, power = 0.0;
  double bend = 0.0;      // -(F^n - F^{n-1}) . (v^{n-1/2} - v^{n-3/2})
  bool begun = false;     // the last forces were those of a setup
  bool known = false;     // F^{n-1} and v^{n-3/2} are of the same particles
  bool closed = false;    // since the last step
  bool reordered = false;
};

}    // namespace mdanim
