// SPDX-License-Identifier: GPL-2.0-only
// Turns counts of samples into parts of cells, in the boxes of cells that they touch or have touched.

#include "liquid/waves/solid_columns.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

namespace mdanim {

static constexpr std::uint64_t NOTHING_STILL = 1469598103934665603ULL;    // the checksum without such solids

SolidColumns::SolidColumns(int nx, int ny, int nz)
    : still(nx, ny, nz), mobile(nx, ny, nz), part(still.count.size(), 0), walled_for(NOTHING_STILL)
{
  values.mass.resize(static_cast<std::size_t>(nx) * ny);
  values.afloat.resize(values.mass.size());
}

// See SolidParts.
static std::uint16_t in_parts(std::int64_t count)
{
  constexpr std::int64_t FULL = SolidParts::FULL, COUNT = Occupancy::FULL_SPREAD;
  return static_cast<std::uint16_t>(std::min(FULL, (count * FULL + COUNT / 2) / COUNT));
}

bool SolidColumns::mark_still(const Basin::AddBodies &bodies, const RankSums &ranks, const Threads &threads, Waves &waves)
{
  constexpr double ANYWHERE = std::numeric_limits<double>::infinity();
  marked.take_in(still.count_anew([&](Occupancy &into) { bodies(into, ANYWHERE); }, ranks, threads));
  std::uint64_t sum = NOTHING_STILL;
  still.touched.each([&](int x, int y, int z) {
    const std::size_t cell = still.number(x, y, z);
    if (still.count[cell]) sum = (sum ^ (static_cast<std::uint64_t>(cell) << 20 ^ still.count[cell])) * 1099511628211ULL;
  });
  if (walled_for != sum) set_walls(waves);
  walled_for = sum;
  return std::exchange(values.still_known, sum) != sum;
}

void SolidColumns::set_walls(Waves &waves) const
{
  std::vector<std::uint16_t> held(part.size(), 0);
  still.touched.each(
      [&](int x, int y, int z) { held[number(y * still.nx + x, z)] = in_parts(still.count[still.number(x, y, z)]); });
  waves.set_walls(held.data());
}

void SolidColumns::mark_moving(const Basin::AddBodies &bodies, double below, double period, const RankSums &ranks,
                               const Threads &threads)
{
  marked.take_in(mobile.count_anew([&](Occupancy &into) { bodies(into, below); }, ranks, threads));
  find_parts(threads);
  find_masses(period, threads);
}

// Computes parts of cells where there is something or was. Counts lie along x and parts along z: in blocks of columns both stay
// in the cache.
void SolidColumns::find_parts(const Threads &threads)
{
  constexpr double CELL = 1.5;    // [ns], approximately
  constexpr int BLOCK = 64;       // columns
  changed.take_in(marked);
  std::atomic<long> with_something{0};
  marked.each_y(threads, CELL, [&](int y) {
    long of_row = 0;
    for (int first = marked.low[0]; first < marked.high[0]; first += BLOCK)
      for (int z = marked.low[2]; z < marked.high[2]; ++z)
        for (int x = first; x < std::min(first + BLOCK, marked.high[0]); ++x) {
          const std::size_t cell = still.number(x, y, z);
          const std::int64_t count = static_cast<std::int64_t>(still.count[cell]) + mobile.count[cell];
          part[number(y * still.nx + x, z)] = in_parts(count);
          of_row += mobile.count[cell] > 0;
        }
    with_something += of_row;
  });
  values.moving = with_something;
  marked = still.touched;
  marked.take_in(mobile.touched);
}

void SolidColumns::find_masses(double period, const Threads &threads)
{
  constexpr double COLUMN = 5.0;              // [ns], approximately
  constexpr double YIELDING = 4.0;            // multiple of the yield that follows from its mass
  constexpr double SOFT = 0.5;                // part of the compression by which the end of a column yields within an update
  constexpr double MASS_STEP = 1.0 / 64.0;    // so that small vibrations do not wake the liquid
  threads.parts(static_cast<long>(values.mass.size()), COLUMN, [&](long first, long end) {
    for (long c = first; c < end; ++c) {
      // An elastic body yields more than its mass says.
      const double own = mobile.mass_of(c), soft = SOFT * mobile.softness_of(c) / (period * period);
      values.mass[c] =
          own > 0.0 ? std::max(MASS_STEP, std::floor(own / (YIELDING + own * soft) / MASS_STEP + 0.5) * MASS_STEP) : 0.0;
      values.afloat[c] = own > 0.0 ? AddedMass::Solids{own, mobile.momentum_of(c) / own} : AddedMass::Solids{};
    }
  });
}

void SolidColumns::give_to(Waves &waves, double again)
{
  waves.set_solids(part.data(), values.mass.data(), again, &changed);
  changed = CellBox();
}

void SolidColumns::set(Values &&now, const SolidParts &parts)
{
  values = std::move(now);
  walled_for = values.still_known;
  part = parts.part;
  marked = changed = CellBox();
  for (int y = 0; y < still.ny; ++y)
    for (int x = 0; x < still.nx; ++x)
      for (int z = 0; z < still.nz; ++z)
        if (part[number(y * still.nx + x, z)]) marked.take_in(x, y, z);
}

bool SolidColumns::floats(int column, int z) const
{
  const std::size_t cell = still.number(column, 0, z);
  return mobile.count[cell] > still.count[cell];
}

long SolidColumns::solid_cells() const
{
  return std::count_if(part.begin(), part.end(), [](std::uint16_t p) { return 2 * p >= SolidParts::FULL; });
}

}    // namespace mdanim
