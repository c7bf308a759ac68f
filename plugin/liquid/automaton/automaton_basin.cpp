// SPDX-License-Identifier: GPL-2.0-only
// Times at which the automaton and the level rule work, and the resulting surface. Reasons and measurements:
// docs/physics-liquid.md.

#include "liquid/automaton/automaton_basin.h"

#include "liquid/automaton/surface.h"
#include "numbers/stopwatch.h"

#include <climits>
#include <cmath>
#include <cstdio>
#include <limits>

namespace mdanim {

static constexpr double SWEEPS_PER_CELL = 8.0;    // per cell of travel of the fastest solid
static constexpr double LEVEL_RATE = 0.11;        // share of exposed cells moved while a shallow-water wave crosses one cell
static constexpr double BETWEEN_MOVES = 0.5;      // cells that it crosses meanwhile
static constexpr double SAMPLED = 4.0;            // cells above the liquid up to which solids are marked
static constexpr double ANYWHERE = std::numeric_limits<double>::infinity();

// The automaton numbers cells and its rim around them by 32 bits; the state, of a byte a cell and 8 a column, goes into a restart
// file, whose parts LAMMPS counts by an int.
std::string AutomatonBasin::too_large(int nx, int ny, int nz)
{
  const double cells = 1.0 * nx * ny * nz, with_rim = (nx + 3.0) * (ny + 2.0) * (nz + 2.0);
  const double state = cells + 8.0 * nx * ny + 1024.0;
  if (std::max(with_rim, state) <= INT_MAX) return "";
  char text[300];
  std::snprintf(
      text, sizeof text,
      "a grid of %d x %d x %d cells is too large: %.3g cells with the rim around them and %.3g bytes of state, %d of each is "
      "the limit; use fewer, larger cells",
      nx, ny, nz, with_rim, state, INT_MAX);
  return text;
}

AutomatonBasin::AutomatonBasin(const Shape &shape, double g, std::uint64_t seed, Vertical vertical, Immersion immersion,
                               const RankSums &ranks)
    : Basin(shape, g, ranks), immersion(immersion), seed(seed), automaton(shape.nx, shape.ny, shape.nz, seed, vertical),
      solid(shape.nx, shape.ny, shape.nz), height(columns(), 0.0), eta(columns(), 0.0), blocked(columns(), 0)
{
}

// --- solids ---

long AutomatonBasin::mark_still(const AddBodies &bodies)
{
  const Lap lap(occupancy_seconds);
  return solid.mark_still([&](Occupancy &into) { bodies(into, ANYWHERE); }, ranks, threads);
}

void AutomatonBasin::mark_moving(const AddBodies &bodies)
{
  const Lap lap(occupancy_seconds);
  solid.mark_moving([&](Occupancy &into) { bodies(into, poured ? top_layer + SAMPLED : ANYWHERE); }, ranks, threads);
}

// Liquid leaves the cells that have become solid; returns the number of cells that changed.
long AutomatonBasin::make_room(std::uint64_t when)
{
  const Lap lap(liquid_seconds);
  return automaton.displace(solid.codes().data(), when);
}

void AutomatonBasin::settle(std::uint64_t when)
{
  make_room(when);
  raise_surface(false);
}

// --- the start ---

// Whole layers below the height, and in the layer that it cuts the same fraction of the open cells.
std::int64_t AutomatonBasin::units_up_to(double level, const std::vector<std::uint8_t> &within) const
{
  const double depth = (level - shape.low.z) / shape.cell.z;
  std::int64_t all = 0;
  for (int z = 0; z < shape.nz && z < depth; ++z) {
    std::int64_t open = 0;
    for (int y = 0; y < shape.ny; ++y)
      for (int x = 0; x < shape.nx; ++x) {
        const std::uint64_t c = cells().number(x, y, z);
        open += within[c] && solid.codes()[c] == SolidCells::OPEN;
      }
    all += static_cast<std::int64_t>(std::min(1.0, depth - z) * static_cast<double>(open) + 0.5);
  }
  return all;
}

Basin::Filled AutomatonBasin::fill(const Amount &amount, const std::vector<std::uint8_t> &within, std::uint64_t when)
{
  const std::int64_t wanted =
      amount.by_level ? units_up_to(amount.value, within) : static_cast<std::int64_t>(amount.value / cell_volume() + 0.5);
  return {wanted, wanted < 1 ? 0 : pour(wanted, within, when)};
}

// Solids first, then liquid into the cells that they leave open.
long AutomatonBasin::pour(std::int64_t wanted, const std::vector<std::uint8_t> &within, std::uint64_t when)
{
  automaton.displace(solid.codes().data(), when);
  units = wanted;
  wait.looked = static_cast<std::int64_t>(when);
  const long left = automaton.fill(units, within.data(), when);
  poured = true;
  raise_surface(false);
  return left;
}

// --- time ---

bool AutomatonBasin::is_due(double fastest, double dt, std::int64_t step)
{
  const std::int64_t steps = wait.look(step, pace.every, dt);
  if (calm) wait.end();
  if (fastest >= 0.0)
    travel += std::sqrt(fastest) * static_cast<double>(steps) * dt / shortest;
  else if (solid.moving())
    return true;    // the last solid has just left
  if (travel >= pace.stride) return true;
  return !calm && wait.time() >= pace.period * std::sqrt(shortest / g);
}

void AutomatonBasin::update(const AddBodies &bodies, std::uint64_t when)
{
  mark_moving(bodies);
  const long changed = make_room(when);
  if (changed || !calm) flow(changed, when);
  travel = 0.0;
  wait.end();
}

// Moves the liquid: sweeps, and the level rule as often as a wave has gone half a cell or solids have changed cells.
void AutomatonBasin::flow(long changed, std::uint64_t when)
{
  bool levelled = false;
  int most = 0;
  {
    const Lap lap(liquid_seconds);
    // A front advances by one cell in a move: half a cell of wave between moves makes its speed 2 sqrt(g depth), that of the
    // front of a broken dam.
    crossed += std::sqrt(g * top_layer * shape.cell.z) * wait.time() / shortest;
    const int waves = static_cast<int>(std::min<double>(MOST_SWEEPS, crossed / BETWEEN_MOVES));
    crossed = std::min(BETWEEN_MOVES, crossed - waves * BETWEEN_MOVES);
    const int moves = std::max(waves, changed ? 1 : 0);
    const int wanted = std::max(static_cast<int>(SWEEPS_PER_CELL * travel + 0.5), moves);
    most = pace.sweeps ? pace.sweeps : std::min(wanted, MOST_SWEEPS);
    for (int k = 0; k < most; ++k) automaton.sweep(when * MOST_SWEEPS + k);
    swept += most;
    levelled = immersion == Immersion::SURFACE && moves > 0;
    for (int k = 0; levelled && k < moves; ++k)
      if (leveller.move(automaton.cells, seed, key_of(when, k), k < waves ? LEVEL_RATE * BETWEEN_MOVES : 0.0, k ? 0 : changed))
        automaton.poured();
  }
  if (changed || most || levelled) raise_surface(levelled);
}

// --- the surface ---

// Computes heights and the smooth surface from the present cells.
void AutomatonBasin::raise_surface(bool just_levelled)
{
  const Lap lap(liquid_seconds);
  calm = leveller.heights(automaton.cells, height.data(), just_levelled);
  smooth();
}

void AutomatonBasin::smooth()
{
  const auto dry = [&](int z) {
    const std::uint8_t *const layer = &cells().content[cells().at(-1, -1, z)];
    return std::all_of(layer, layer + cells().layer, [](std::uint8_t q) { return q == 0; });
  };
  top_layer = shape.nz;
  while (top_layer > 0 && dry(top_layer - 1)) --top_layer;
  for (int y = 0; y < shape.ny; ++y)
    for (int x = 0; x < shape.nx; ++x) {
      const std::size_t column = static_cast<std::size_t>(y) * shape.nx + x;
      blocked[column] = std::isnan(height[column]) && is_parted(x, y);
    }
  smooth_surface(shape.nx, shape.ny, height.data(), blocked.data(), eta.data());
  // Under a lid from wall to wall no column has a height of its own: the surface is then where the open cells would hold the
  // liquid.
  if (std::all_of(height.begin(), height.end(), [](double h) { return std::isnan(h); }))
    std::fill(eta.begin(), eta.end(), shut_in_height());
  lowest_eta = *std::min_element(eta.begin(), eta.end());
}

// Whether the solid that bounds the liquid of a column without a height never moves: each side of a wall has a level of its own.
bool AutomatonBasin::is_parted(int x, int y) const
{
  const Cells &c = cells();
  int z = top_layer - 1;
  while (z >= 0 && !c.content[c.at(x, y, z)]) --z;
  if (z < 0)    // dry: a solid that stands on the floor or hangs above it
    while (++z < c.nz && c.open[c.at(x, y, z)]) {}
  else if (z + 1 < c.nz && !c.open[c.at(x, y, z + 1)])
    ++z;    // the solid that shuts the liquid in
  else
    while (z >= 0 && c.open[c.at(x, y, z)]) --z;    // the solid that a film lies on
  return z >= 0 && z < c.nz && c.still[c.at(x, y, z)];
}

// Height up to which open cells, from the lowest layer up, hold all the liquid.
double AutomatonBasin::shut_in_height() const
{
  std::int64_t left = automaton.total();
  for (int z = 0; z < shape.nz; ++z) {
    std::int64_t open = 0;
    for (int y = 0; y < shape.ny; ++y)
      for (int x = 0; x < shape.nx; ++x) open += cells().open[cells().at(x, y, z)] != Cells::SOLID;
    if (open && left <= open) return z + static_cast<double>(left) / static_cast<double>(open);
    left -= open;
  }
  return shape.nz;
}

// --- what acts on solids ---

// The paper's literal rule: liquid in any of the cells around.
double AutomatonBasin::liquid_around(const Vec3 &place) const
{
  if (!(place.z >= 0.0 && place.z < shape.nz)) return 0.0;
  const int x = std::min(static_cast<int>(place.x), shape.nx - 1), y = std::min(static_cast<int>(place.y), shape.ny - 1),
            z = static_cast<int>(place.z);
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (cells().content[cells().at(x + dx, y + dy, z + dz)]) return 1.0;
  return 0.0;
}

}    // namespace mdanim
