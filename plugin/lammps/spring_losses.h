// SPDX-License-Identifier: GPL-2.0-only
// The energy that is gone where fixes change springs (tearing/law.h), at the ends that are here.

#pragma once

#include "numbers/vec3.h"
#include "pointers.h"
#include "tearing/law.h"

#include <vector>

namespace mdanim {

// Counts springs that are changed before the forces of a step, and closes the account when all forces of the step are there.
class SpringLosses : protected LAMMPS_NS::Pointers {
 public:
  explicit SpringLosses(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp) {}

  // Counts the end i of a spring to j, if it is a local particle: `sign` is 1 of a spring that is there no longer, -1 of one that
  // is there instead.
  void count(int i, int j, const LoadFree &spring, double sign);
  // The same of anything else with forces on i, at places now and a step before, and a part of its energy.
  void count(int i, double energy, const Vec3 &now, const Vec3 &then);
  // Ends the step, for particles of a group.
  void close(int groupbit);
  double total() const { return lost; }    // on this rank

 private:
  std::vector<Vec3> less;    // forces of what is there no longer on local particles; empty where nothing was changed
  double lost = 0.0;
};

}    // namespace mdanim
