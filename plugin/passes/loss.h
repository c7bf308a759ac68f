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
//   sum_{m<n} [W^m - dt/12 (F^{m+1} - F^{m-1}) . (v^{m+1/2} - v^{m-1/2})]
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
    older.swap(last);
    last.swap(force);
    force.assign(particles, Vec3());
    return force;
  }

  // Closes a step when the forces are complete. v is the velocity that they were computed with.
  void step(const double *const *v, double dt, bool setup)
  {
    const int particles = static_cast<int>(force.size());
    if (reordered) kept = 0;
    reordered = false;
    const double now = -sum_of(force, v);
    if (setup) sum += tail;
    // Where particles were re-ordered, F^n . v^{n+1/2} is taken for the mean of F^n . v^{n-1/2} and F^{n+1} . v^{n+1/2}.
    else if (begun)
      sum += 0.5 * dt * power;
    else if (power != 0.0 || now != 0.0)
      sum += 0.5 * dt * (power + (kept ? -sum_of(last, v) : 0.5 * (power + now)));
    double change = 0.0;
    if (setup)
      bend = 0.0;
    else if (kept >= 2)
      bend = -ahead;    // else particles were re-ordered: that of the last step is taken once more
    if (!setup && kept >= 2)
      for (int i = 0; i < particles; ++i) bend += dot(force[i] - older[i], vec3(v[i]) - seen[i]);
    if (!setup && kept >= 1)
      for (int i = 0; i < particles; ++i) change += dot(force[i] - last[i], vec3(v[i]));
    sum -= dt / 12.0 * bend;
    power = now;
    tail = setup ? 0.0 : 0.5 * dt * power + dt / 12.0 * change;
    begun = setup;
    kept = setup ? 0 : std::min(kept + 1, 2);
    seen.resize(particles);
    for (int i = 0; i < particles; ++i) seen[i] = vec3(v[i]);
    ahead = 0.0;
  }

  // For steps that passes take (simd_blocks.h), which keep F^{n-1} and v^{n-3/2} meanwhile. Before these steps the account so far
  // is closed; v is the velocity of the next forces. From then on the second half of the sum with F^{m+1} - F^{m-1} is taken one
  // step `ahead`.
  void close(const double *const *v, double dt)
  {
    sum += 0.5 * dt * (begun ? power : power - sum_of(force, v));
    if (kept >= 2)
      for (std::size_t i = 0; i < force.size(); ++i) ahead += dot(last[i], vec3(v[i]) - seen[i]);
    power = tail = 0.0;
    begun = true;
  }
  // Adds one such step.
  void passed(const DashpotSums &sums, double dt)
  {
    sum -= 0.5 * dt * sums.work;
    if (kept >= 2) bend = sums.bend - ahead;
    sum -= dt / 12.0 * bend;
    ahead = kept >= 1 ? sums.ahead : 0.0;
    kept = std::min(kept + 1, 2);
  }
  // Called after them: F^{n-1} and v^{n-3/2} are back in latest() and latest_seen().
  void reopen() { last.assign(force.size(), Vec3()); }
  std::vector<Vec3> &latest() { return force; }
  std::vector<Vec3> &latest_seen() { return seen; }

  // Energy lost up to the last step.
  double total() const { return sum + tail; }
  std::size_t bytes() const
  {
    return (force.capacity() + last.capacity() + older.capacity() + seen.capacity()) * sizeof(Vec3) +
           order.capacity() * sizeof(long long);
  }

 private:
  static double sum_of(const std::vector<Vec3> &f, const double *const *v)
  {
    double all = 0.0;
    for (std::size_t i = 0; i < f.size(); ++i) all += dot(f[i], vec3(v[i]));
    return all;
  }

  std::vector<Vec3> force, last, older;    // F^n, F^{n-1}, F^{n-2} of the particles here
  std::vector<Vec3> seen;                  // v^{n-1/2}
  std::vector<long long> order;            // tags
  int kept = 0;                            // how many older forces are of the same particles
  double sum = 0.0, tail = 0.0, power = 0.0;
  double bend = 0.0;     // sum of (F^n - F^{n-2}) . (v^{n-1/2} - v^{n-3/2})
  double ahead = 0.0;    // sum of F^{n-2} . (v^{n-1/2} - v^{n-3/2}), as far as `older` no longer tells it
  bool begun = false;    // the last forces were those of a setup
  bool reordered = false;
};

}    // namespace mdanim
