// SPDX-License-Identifier: GPL-2.0-only
// What this processor takes for a pass with each set of instructions, and for a thread to wake up: measured once, in
// milliseconds.

#ifndef MDANIM_CALIBRATION_H
#define MDANIM_CALIBRATION_H

#include "engine/kernels.h"

#include <vector>

namespace mdanim {

struct Calibration {
  struct Width {
    const Kernels *kernels;
    double springs, dashpots;    // a particle's step in a pass, without and with dashpots [ns]
  };
  std::vector<Width> widths;    // all that run here, the widest first
  double waking;    // what a call of the team takes longer than its tasks when its threads sleep [ns]; 0 where that is not known

  // Of a pass over springs, where some have dashpots or none.
  const Width &fastest(bool damped) const;
  static double of(const Width &width, bool damped) { return damped ? width.dashpots : width.springs; }
};

// Measures it; takes some 30 ms.
Calibration measure_calibration();

// That of this process: what was given, or else what is measured when it is first asked for.
const Calibration &calibration();
void give_calibration(Calibration known);

// The least that a thread is asked for [ns]: two such tasks, one for each of two threads, take less than one thread even where
// the other one has to be woken.
double least_task();
// Particles, at least one, that take so long in a pass.
int particles_of(double ns, const Kernels &kernels, bool damped);

}    // namespace mdanim

#endif
