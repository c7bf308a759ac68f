// SPDX-License-Identifier: GPL-2.0-only
// The work of an acceleration that changes with time.

#pragma once

#include "numbers/vec3.h"

namespace mdanim {

// Work that an acceleration does on masses with the momentum P = sum of m v, from step to step:
//   W = sum_n dt (g_n + g_{n+1})/2 . P^{n+1/2},
// which is what leap-frog adds to the kinetic energy of v^n = (v^{n-1/2} + v^{n+1/2})/2, but for a sum that telescopes. Of masses
// that come or go between two steps nothing is counted but what they do while they are there.
class AccelerationWork {
 public:
  void begin(const Vec3 &g) { before = g; }
  // Goes to the next step, and returns g_n + g_{n+1}.
  Vec3 turn(const Vec3 &g)
  {
    const Vec3 both = before + g;
    before = g;
    return both;
  }
  // Adds the work of that step: `power` is (g_n + g_{n+1}) . P.
  void add(double power, double dt) { done += 0.5 * dt * power; }
  double total() const { return done; }

 private:
  Vec3 before;
  double done = 0.0;
};

}    // namespace mdanim
