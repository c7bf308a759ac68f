// SPDX-License-Identifier: GPL-2.0-only
// run_style verlet of LAMMPS, whose declaration in lammps/verlet.h is compared with the library that is in the process: another
// build of the same version, or one with another standard library, may have another class.

#pragma once

#include "lammps/verlet.h"

#include <cstdint>

namespace LAMMPS_NS {

// Whether the library's functions stand in its table where the declaration has them, and its constructor writes the declared
// members and nothing beyond them. Numbers that the constructor does not set are checked by CheckedVerlet::init().
bool verlet_is_as_declared(LAMMPS *lmp);

// Verlet between members that the library must write and words that it must not.
class CheckedVerlet : public Verlet {
 public:
  CheckedVerlet(LAMMPS *lmp, int narg, char **arg);
  void init() override;    // an error where the library wrote elsewhere

 private:
  static constexpr int WORDS = 8;
  static constexpr std::uint64_t UNTOUCHED = 0xa5a5a5a5a5a5a5a5;

  std::uint64_t behind[WORDS];
};

}    // namespace LAMMPS_NS
