// SPDX-License-Identifier: GPL-2.0-only
// Energy that velocity-dependent forces take in the course of a run.

#ifndef MDANIM_LOSS_H
#define MDANIM_LOSS_H

namespace mdanim {

// Forces are computed with v^{n-1/2}, so what is known at step n is P_n = -F^n . v^{n-1/2}. F^n acts from
// n-1/2 to n+1/2, where the mean velocity is close to (3 v^{n-1/2} + v^{n+1/2}) / 4: its work is dt (3 P_n +
// P_{n+1}) / 4. In the half step before the end of a run and in the one after a setup, whose forces see v^n,
// it acts for dt/2 only. All in all:
//   lost = dt (3/8 P_0 + 7/8 P_1 + P_2 + ... + P_{n-1} + 3/4 P_n), an error of second order in dt.
// Where the damping coefficient g changes along the way, P_n is to be taken with 3/4 g_n + 1/4 g_{n-1}.
class Loss {
 public:
  void setup(double power)
  {
    sum += tail;
    tail = 0.0;
    last = power;
    first = true;
  }
  void step(double power, double dt)
  {
    sum += (first ? 0.375 : 0.5) * dt * (last + power);
    tail = 0.25 * dt * power;
    last = power;
    first = false;
    total = sum + tail;
  }
  bool idle() const { return last == 0.0 && tail == 0.0; }

  double total = 0.0;    // up to the last step

 private:
  double sum = 0.0, tail = 0.0, last = 0.0;
  bool first = true;
};

}    // namespace mdanim

#endif
