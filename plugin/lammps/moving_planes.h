// SPDX-License-Identifier: GPL-2.0-only
// Planes, and basins, that fixes mdanim/drive move.

#pragma once

#include "numbers/vec3.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {
class LAMMPS;
class FixMdanimDrive;
}    // namespace LAMMPS_NS

namespace mdanim {

class MovingPlanes {
 public:
  explicit MovingPlanes(LAMMPS_NS::LAMMPS *lmp) : lmp(lmp) {}

  // A plane by its number in the command, and the ID of the fix that moves it.
  void add(int plane, const char *fix) { all.push_back({plane, fix, nullptr, {}}); }
  bool any() const { return !all.empty(); }
  // Looks up the fixes; to be called before each run. `fix` begins messages. A plane that is turned is refused.
  void init(const std::string &fix);

  // Calls visit(plane, displacement from the start, way of the step that ends here) of each.
  template <class Visit> void each(const Visit &visit)
  {
    for (Moving &one : all) visit(one.plane, shift(one, 0), shift(one, 0) - shift(one, -1));
  }
  // Displacement of the first one from the start; its velocity this time ago, by where it was a step before and behind.
  Vec3 place() const { return shift(all.front(), 0); }
  Vec3 velocity(double ago) const;
  // Lists have been made with planes where they are now.
  void listed()
  {
    for (Moving &one : all) one.at_lists = shift(one, 0);
  }
  // Whether a plane will be farther than this from where it was then [distance] in the next step.
  bool needs_lists(double most)
  {
    for (Moving &one : all)
      if (length(shift(one, 1) - one.at_lists) > most) return true;
    return false;
  }

 private:
  struct Moving {
    int plane;
    std::string id;
    LAMMPS_NS::FixMdanimDrive *drive;
    Vec3 at_lists;
  };
  Vec3 shift(const Moving &one, int step) const;    // in the step before, now, in the next one

  LAMMPS_NS::LAMMPS *lmp;
  std::vector<Moving> all;
};

}    // namespace mdanim
