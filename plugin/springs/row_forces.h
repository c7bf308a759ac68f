// SPDX-License-Identifier: GPL-2.0-only
// Forces and energies of springs in rows, as plain steps compute them.

#pragma once

#include "springs/spring_kernels.h"
#include "springs/spring_rows.h"
#include "threads/team.h"

#include <vector>

namespace mdanim {

// The springs of the particles 0 to rows.size() - 1. Where rows hold upper partners only, these are among the particles, each
// spring occurs once, and `farthest` is the largest offset of a partner.
struct RowSprings {
  const SpringRows &rows;
  bool upper_only;
  int farthest;
  const std::vector<Spring> &spring;       // by type
  const std::vector<SpringCoeffs> &law;    // by type
};

// Places and velocities of particles and their partners, and forces, one particle after the other.
struct RowParticles {
  const double *x, *v;
  double *f;
};

// Adds the forces of springs. Each particle sums those of its lower partners and those of its upper ones by themselves, in the
// order of its row, and adds the two sums to its force once. `dashpots` (null for none) has the forces of dashpots on each
// particle added; a dashpot pushes both its particles, so one thread computes all. Returns the energy of the springs where it is
// asked for, else 0. No result depends on threads.
double add_row_forces(const RowSprings &springs, const RowParticles &particles, bool with_energy, std::vector<Vec3> *dashpots,
                      const Threads &threads, const SpringKernels &kernels);

}    // namespace mdanim
