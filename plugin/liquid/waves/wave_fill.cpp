// SPDX-License-Identifier: GPL-2.0-only
// The level of an amount, by bisection.

#include "liquid/waves/wave_fill.h"

#include <algorithm>

namespace mdanim {

// The highest of the numbers [low, high) that is poured to without more than `want`.
template <class PouredTo> static std::int64_t highest(std::int64_t low, std::int64_t high, Units want, const PouredTo &poured_to)
{
  while (high - low > 1) {
    const std::int64_t middle = low + (high - low) / 2;
    (poured_to(middle) <= want ? low : high) = middle;
  }
  return low;
}

Basin::Filled fill_with(Waves &waves, const Basin &basin, const Basin::Amount &amount, const std::vector<std::uint8_t> &within,
                        const std::function<bool(int column, int z)> &floats)
{
  const Basin::Shape &shape = basin.shape;
  const int columns = basin.columns();
  std::vector<double> low(columns, 0.0), high(columns, 0.0), height(columns, 0.0);
  for (int c = 0; c < columns; ++c) {
    int z = 0;
    const auto wanted = [&](int layer) { return within[static_cast<std::size_t>(layer) * columns + c] != 0; };
    while (z < shape.nz && !wanted(z)) ++z;
    low[c] = z;
    while (z < shape.nz && wanted(z)) ++z;
    high[c] = z;
  }
  std::vector<std::uint8_t> hollow;
  const auto leave_hollows_dry = [&](std::int64_t level) {
    if (!amount.into_hollows) hollow = waves.hollows(static_cast<double>(level) / UNITS_PER_CELL, floats);
  };
  // Pours up to a level, in units, and one unit more in the first columns.
  const auto pour = [&](std::int64_t level, std::int64_t first) {
    for (int c = 0; c < columns; ++c)
      height[c] = std::clamp(static_cast<double>(level + (c < first)) / UNITS_PER_CELL, low[c], high[c]);
    waves.pour(height.data(), low.data(), hollow);
    return waves.total();
  };
  const std::int64_t most = static_cast<std::int64_t>(shape.nz) * UNITS_PER_CELL;
  std::int64_t wanted = 0;    // whole cells
  if (amount.by_level) {
    const auto level = static_cast<std::int64_t>((amount.value - shape.low.z) / shape.cell.z * UNITS_PER_CELL + 0.5);
    leave_hollows_dry(level);
    wanted = (pour(level, 0) + UNITS_PER_CELL / 2) / UNITS_PER_CELL;
  } else
    wanted = static_cast<std::int64_t>(amount.value / basin.cell_volume() + 0.5);
  const Units room = pour(most, 0);
  if (amount.by_level) wanted = std::min(wanted, room / UNITS_PER_CELL);    // the nearest whole number may be too much
  if (wanted < 1) return {wanted, 0};
  const Units want = wanted * UNITS_PER_CELL;
  const auto level_of_all = [&] { return highest(0, most + 1, want, [&](std::int64_t l) { return pour(l, 0); }); };
  if (!amount.by_level) leave_hollows_dry(level_of_all());
  const std::int64_t level = level_of_all();
  pour(level, highest(0, columns + 1, want, [&](std::int64_t n) { return pour(level, n); }));
  return {wanted, room < want ? static_cast<long>((want - room + UNITS_PER_CELL - 1) / UNITS_PER_CELL) : 0};
}

}    // namespace mdanim
