// SPDX-License-Identifier: GPL-2.0-only
// A step of run_style verlet in two parts.

#pragma once

#include "lammps/checked_verlet.h"

namespace LAMMPS_NS {

// run_style verlet whose steps can be left after the first half and finished later. Lists are made when a derived class finds
// them due: between the halves it may have moved particles through many steps.
class SplitVerlet : public CheckedVerlet {
 protected:
  using CheckedVerlet::CheckedVerlet;
  void begin_step();
  void finish_step();
  bool rebuild_lists();    // whether every particle is where it was in the arrays

  virtual bool lists_are_due() = 0;    // in this step; called once
};

}    // namespace LAMMPS_NS
