// SPDX-License-Identifier: GPL-2.0-only
// compute mdanim/timestep: the largest stable time step for the springs, dashpots and walls of a group.

#pragma once

#include "compute.h"

#include <vector>

namespace LAMMPS_NS {

class ComputeMdanimTimestep : public Compute {
 public:
  ComputeMdanimTimestep(class LAMMPS *, int, char **);
  ~ComputeMdanimTimestep() override;

  void init() override;
  double compute_scalar() override;
  void compute_vector() override;

 private:
  const class BondMdanimHarmonic *springs() const;
  std::vector<class FixMdanimWall *> walls() const;
};

}    // namespace LAMMPS_NS
