// SPDX-License-Identifier: GPL-2.0-only
// Sums of impulses in whole units.

#include "liquid/waves/solid_impulses.h"

#include <algorithm>
#include <numeric>

namespace mdanim {

static constexpr double IMPULSE_UNIT = 1.0 / (1LL << 40);
static constexpr double PUSH_UNIT = 1.0 / (1LL << 32);    // cells of liquid

// std::llround is a call, and slower.
static std::int64_t whole(double x) { return static_cast<std::int64_t>(x + (x < 0.0 ? -0.5 : 0.5)); }

void SolidImpulses::take(const Vec3 &place, const Vec3 &impulse)
{
  if (!(place.x >= 0.0 && place.x <= shape.nx && place.y >= 0.0 && place.y <= shape.ny)) return;
  const int x = std::min(static_cast<int>(place.x), shape.nx - 1), y = std::min(static_cast<int>(place.y), shape.ny - 1);
  const double unit = cell_volume() / unit_of_time * IMPULSE_UNIT;
  const int column = y * shape.nx + x;
  sums[column] += whole(impulse.x / (unit * shape.cell.x));
  sums[columns() + column] += whole(impulse.y / (unit * shape.cell.y));
}

void SolidImpulses::take_push(const Vec3 &volume_along)
{
  const double unit = cell_volume() * PUSH_UNIT;
  sums[2 * columns()] += whole(volume_along.x / unit);
  sums[2 * columns() + 1] += whole(volume_along.y / unit);
}

SolidImpulses::Totals SolidImpulses::sum_over(const RankSums &ranks) const
{
  std::vector<std::int64_t> all = sums;
  ranks.add_wide(all.data(), static_cast<int>(all.size()));
  const auto middle = all.begin() + columns(), end = middle + columns();
  const auto sum = [](auto from, auto to) {
    return static_cast<double>(std::accumulate(from, to, std::int64_t{0})) * IMPULSE_UNIT;
  };
  Totals found;
  for (auto units = all.begin(); units != end; ++units) found.given.push_back(static_cast<double>(*units) * IMPULSE_UNIT);
  found.all_given = {sum(all.begin(), middle), sum(middle, end), 0.0};
  // Force in units of the waves: density, g and cell are 1 there, and time is that of a square cell.
  found.push = {static_cast<double>(end[0]) * PUSH_UNIT * shape.cell.y / shape.cell.z,
                static_cast<double>(end[1]) * PUSH_UNIT * shape.cell.x / shape.cell.z, 0.0};
  return found;
}

}    // namespace mdanim
