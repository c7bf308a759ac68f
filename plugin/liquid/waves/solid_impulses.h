// SPDX-License-Identifier: GPL-2.0-only
// The impulses of solids on waves, and of waves on solids, since the last update.

#pragma once

#include "liquid/basin.h"
#include "liquid/rank_sums.h"
#include "numbers/vec3.h"

#include <cstdint>
#include <vector>

namespace mdanim {

// Summed in whole numbers: no sum depends on the order of solids or ranks.
class SolidImpulses {
 public:
  // `unit_of_time` of the waves [time].
  SolidImpulses(const Basin::Shape &shape, double unit_of_time)
      : shape(shape), unit_of_time(unit_of_time), sums(2 * columns() + 2, 0)
  {
  }

  // Takes the impulse of a solid of this rank at a place, over the liquid's density.
  void take(const Vec3 &place, const Vec3 &impulse);
  // Takes the push on a solid in a step, over the weight of liquid of volume 1.
  void take_push(const Vec3 &volume_along);
  // Sums of all ranks, in units of the waves.
  struct Totals {
    std::vector<double> given;    // to the liquid of each column: along x, then along y
    Vec3 all_given, push;         // sum of these; push on solids along x and y, in all steps together
  };
  Totals sum_over(const RankSums &ranks) const;
  void clear() { sums.assign(sums.size(), 0); }

 private:
  int columns() const { return shape.nx * shape.ny; }
  double cell_volume() const { return shape.cell.x * shape.cell.y * shape.cell.z; }

  const Basin::Shape shape;
  const double unit_of_time;
  std::vector<std::int64_t> sums;    // for each column along x, then along y; then the push along x and y
};

}    // namespace mdanim
