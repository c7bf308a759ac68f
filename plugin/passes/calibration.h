// SPDX-License-Identifier: GPL-2.0-only
// What this processor takes for a pass with each set of instructions, and for threads to come: measured once, in milliseconds.

#ifndef MDANIM_CALIBRATION_H
#define MDANIM_CALIBRATION_H

#include "passes/kernels.h"
#include "threads/team.h"

#include <vector>

namespace mdanim {

struct Calibration {
  struct Width {
    const Kernels *kernels;
    double springs, dashpots;    // a particle's step in a pass, without and with dashpots [ns]
  };
  std::vector<Width> widths;    // all that run here, the widest first
  // What a call of the team takes longer than its tasks [ns], when its threads sleep and when they are awake; 0 where that is
  // not known.
  double waking, calling;

  // Of a pass over springs, where some have dashpots or none.
  const Width &fastest(bool damped) const;
  static double of(const Width &width, bool damped) { return damped ? width.dashpots : width.springs; }
};

// Measures it; takes some 30 ms.
Calibration measure_calibration();

// That of this process: what was given, or else what is measured when it is first asked for.
const Calibration &calibration();
void give_calibration(Calibration known);

// For a step of so many threads.
Threads threads_here(int many);
// A pass of one thread over so many particles [ns].
double ns_of_pass(int particles, const Kernels &kernels, bool damped);

}    // namespace mdanim

#endif
