// SPDX-License-Identifier: GPL-2.0-only
// Times of updates of waves, the solid parts of the basin, and the liquid at a particle.

#include "liquid/waves/wave_basin.h"

#include "numbers/stopwatch.h"

#include <atomic>
#include <climits>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace mdanim {

namespace {

constexpr double SAMPLED = 4.0;    // cells above the liquid up to which solids are marked
constexpr double LONGEST = 0.2;    // time that the liquid advances at once, in sqrt(cell/g)
constexpr double ROUNDING = 1e-9;
constexpr double ASLEEP = 1.0 / 64.0;       // cells that a solid may go before liquid at rest is updated
constexpr double SLOW = 1.0;                // time constant of the sideways push, in sqrt(cell/g)
constexpr double CALMING = 1.0;             // rate at which columns of solids lose their vibration, in sqrt(g/cell)
constexpr double YIELDING = 4.0;            // multiple of the yield that follows from its mass
constexpr double SOFT = 0.5;                // part of the compression by which the end of a column yields within an update
constexpr double MASS_STEP = 1.0 / 64.0;    // so that small vibrations do not wake the liquid
constexpr double FLATTEST = 1.25;           // longest edge of a cell over the shortest
constexpr double IMPULSE_UNIT = 1.0 / (1LL << 40);
constexpr double PUSH_UNIT = 1.0 / (1LL << 32);    // cells of liquid
constexpr double ANYWHERE = std::numeric_limits<double>::infinity();

}    // namespace

// A state, of 4 bytes a cell at most and some 200 a column, goes into a restart file, whose parts LAMMPS counts by an int.
std::string WaveBasin::unusable(const Shape &shape)
{
  char text[300];
  const Vec3 &c = shape.cell;
  const double longest = std::max({c.x, c.y, c.z}), shortest = std::min({c.x, c.y, c.z});
  const double state = 4.0 * shape.nx * shape.ny * shape.nz + 200.0 * shape.nx * shape.ny;
  if (longest > FLATTEST * shortest)
    std::snprintf(
        text, sizeof text,
        "cells of %.4g x %.4g x %.4g are too far from cubes for waves; the longest edge may be %.4g of the shortest: use "
        "another number of cells, or model surface",
        c.x, c.y, c.z, FLATTEST);
  else if (state > INT_MAX)
    std::snprintf(
        text, sizeof text,
        "a grid of %d x %d x %d cells is too large for waves: %.3g bytes of state, %d is the limit; use fewer, larger cells",
        shape.nx, shape.ny, shape.nz, state, INT_MAX);
  else
    return "";
  return text;
}

WaveBasin::WaveBasin(const Shape &shape, double g, double calm, double spray, std::uint64_t seed, const RankSums &ranks)
    : Basin(shape, g), ranks(ranks), unit_of_time(std::sqrt(shape.cell.x * shape.cell.y / (g * shape.cell.z))),
      waves(shape.nx, shape.ny, shape.nz), push(shape.nx, shape.ny, shape.nz), makers(shape.nx, shape.ny),
      drops(shape.nx, shape.ny, seed), still(shape.nx, shape.ny, shape.nz), mobile(shape.nx, shape.ny, shape.nz),
      part(still.count.size(), 0), mass(columns(), 0.0), afloat(columns()), rising(columns()), from_solids(2 * columns() + 2, 0),
      heads(columns(), 0.0), tops(columns(), 0.0), hollow(columns(), 0)
{
  waves.run.law.calm = calm * unit_of_time;
  drops.share = spray;
}

// --- makers of waves ---

void WaveBasin::add_wave(int side, double amplitude, double period, double depth)
{ makers.add_paddle(static_cast<WaveMakers::Side>(side), amplitude / shape.cell.z, period / unit_of_time, depth / shape.cell.z); }

void WaveBasin::add_current(int side, double speed)
{
  const double cell = side == WaveMakers::WEST || side == WaveMakers::EAST ? shape.cell.x : shape.cell.y;
  makers.add_current(static_cast<WaveMakers::Side>(side), speed * unit_of_time / cell);
}

void WaveBasin::add_flow(const Vec3 &low, const Vec3 &high, double rate, double ux, double uy)
{
  const double cells = std::fabs(rate) * unit_of_time / cell_volume();
  WaveMakers::Mouth mouth{{0, 0}, {0, 0}, (0.5 * (low.z + high.z) - shape.low.z) / shape.cell.z};
  const auto columns_of = [&](int d, double from, double to, int n) {
    mouth.low[d] = std::clamp(static_cast<int>(std::ceil(from - 0.5)), 0, n - 1);
    mouth.high[d] = std::clamp(static_cast<int>(std::ceil(to - 0.5)), mouth.low[d] + 1, n);
  };
  columns_of(0, (low.x - shape.low.x) / shape.cell.x, (high.x - shape.low.x) / shape.cell.x, shape.nx);
  columns_of(1, (low.y - shape.low.y) / shape.cell.y, (high.y - shape.low.y) / shape.cell.y, shape.ny);
  if (rate < 0.0)
    makers.add_drain(mouth, cells);
  else
    makers.add_inflow(mouth, cells, ux * unit_of_time / shape.cell.x, uy * unit_of_time / shape.cell.y);
}

// --- solids ---

// See SolidParts.
static std::uint16_t in_parts(std::int64_t count)
{
  constexpr std::int64_t FULL = SolidParts::FULL, COUNT = Occupancy::FULL_SPREAD;
  return static_cast<std::uint16_t>(std::min(FULL, (count * FULL + COUNT / 2) / COUNT));
}

long WaveBasin::mark_still(const AddBodies &bodies)
{
  const Lap lap(occupancy_seconds);
  marked.take_in(still.touched);
  still.clear(threads);
  bodies(still, ANYWHERE);
  still.sum_over(ranks, threads);
  std::uint64_t sum = NOTHING_STILL;
  still.touched.each([&](int x, int y, int z) {
    const std::size_t cell = still.number(x, y, z);
    if (still.count[cell]) sum = (sum ^ (static_cast<std::uint64_t>(cell) << 20 ^ still.count[cell])) * 1099511628211ULL;
  });
  if (walled_for != sum) set_walls();
  walled_for = sum;
  const bool changed = sum != still_known;
  still_known = sum;
  return changed;
}

void WaveBasin::set_walls()
{
  std::vector<std::uint16_t> held(part.size(), 0);
  still.touched.each(
      [&](int x, int y, int z) { held[part_number(y * shape.nx + x, z)] = in_parts(still.count[still.number(x, y, z)]); });
  waves.set_walls(held.data());
}

void WaveBasin::mark_moving(const AddBodies &bodies)
{
  const Lap lap(occupancy_seconds);
  marked.take_in(mobile.touched);
  mobile.clear(threads);
  bodies(mobile, poured ? top_layer + SAMPLED : shape.nz);    // solids above the basin have no place in the liquid
  mobile.sum_over(ranks, threads);
  count_parts();
}

// Computes parts of cells from counts, where there is something or was. Counts lie along x and parts along z: in blocks of
// columns both stay in the cache.
void WaveBasin::count_parts()
{
  marked.take_in(still.touched);
  marked.take_in(mobile.touched);
  changed.take_in(marked);
  constexpr double CELL = 1.5, COLUMN = 5.0;    // [ns], approximately
  constexpr int BLOCK = 64;                     // columns
  std::atomic<long> with_something{0};
  marked.each_y(threads, CELL, [&](int y) {
    long of_row = 0;
    for (int first = marked.low[0]; first < marked.high[0]; first += BLOCK)
      for (int z = marked.low[2]; z < marked.high[2]; ++z)
        for (int x = first; x < std::min(first + BLOCK, marked.high[0]); ++x) {
          const std::size_t cell = still.number(x, y, z);
          const std::int64_t count = static_cast<std::int64_t>(still.count[cell]) + mobile.count[cell];
          part[part_number(y * shape.nx + x, z)] = in_parts(count);
          of_row += mobile.count[cell] > 0;
        }
    with_something += of_row;
  });
  moving = with_something;
  marked = CellBox();
  marked.take_in(still.touched);
  marked.take_in(mobile.touched);
  const double period = std::min(pace.period, LONGEST);
  threads.parts(columns(), COLUMN, [&](long first, long end) {
    for (long c = first; c < end; ++c) {
      // An elastic body yields more than its mass says.
      const double own = mobile.mass_of(c), soft = SOFT * mobile.softness_of(c) / (period * period);
      mass[c] = own > 0.0 ? std::max(MASS_STEP, std::floor(own / (YIELDING + own * soft) / MASS_STEP + 0.5) * MASS_STEP) : 0.0;
      afloat[c] = own > 0.0 ? AddedMass::Solids{own, mobile.momentum_of(c) / own} : AddedMass::Solids{};
    }
  });
}

// --- the start ---

Basin::Filled WaveBasin::fill(const Amount &amount, const std::vector<std::uint8_t> &within, std::uint64_t when)
{
  waves.set_solids(part.data(), mass.data());
  changed = CellBox();
  std::vector<double> low(columns(), 0.0), high(columns(), 0.0), height(columns(), 0.0);
  for (int c = 0; c < columns(); ++c) {
    int z = 0;
    const auto wanted = [&](int layer) { return within[static_cast<std::size_t>(layer) * columns() + c] != 0; };
    while (z < shape.nz && !wanted(z)) ++z;
    low[c] = z;
    while (z < shape.nz && wanted(z)) ++z;
    high[c] = z;
  }
  std::vector<std::uint8_t> hollow;
  const auto leave_hollows_dry = [&](std::int64_t level) {
    if (amount.into_hollows) return;
    hollow = waves.hollows(static_cast<double>(level) / UNITS_PER_CELL, [this](int column, int z) {
      const std::size_t cell = static_cast<std::size_t>(z) * columns() + column;
      return mobile.count[cell] > still.count[cell];
    });
  };
  // Pours up to a level, in units, and one unit more in the first columns.
  const auto pour = [&](std::int64_t level, int first) {
    for (int c = 0; c < columns(); ++c)
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
    wanted = static_cast<std::int64_t>(amount.value / cell_volume() + 0.5);
  const Units room = pour(most, 0);
  if (amount.by_level) wanted = std::min(wanted, room / UNITS_PER_CELL);    // the nearest whole number may be too much
  if (wanted < 1) return {wanted, 0};
  const Units want = wanted * UNITS_PER_CELL;
  const auto highest = [&](std::int64_t low_end, std::int64_t high_end, const auto &poured_to) {    // that holds no more
    while (high_end - low_end > 1) {
      const std::int64_t middle = low_end + (high_end - low_end) / 2;
      (poured_to(middle) <= want ? low_end : high_end) = middle;
    }
    return low_end;
  };
  const auto level_of_all = [&] { return highest(0, most + 1, [&](std::int64_t l) { return pour(l, 0); }); };
  if (!amount.by_level) leave_hollows_dry(level_of_all());
  const std::int64_t level = level_of_all();
  pour(level, static_cast<int>(highest(0, columns() + 1, [&](std::int64_t n) { return pour(level, static_cast<int>(n)); })));
  units = waves.total();
  energy_at_start = energy_now();
  poured = true;
  stale = true;    // so that the first check updates
  wait.looked = static_cast<std::int64_t>(when);
  look();
  find_push(1.0, 0.0);
  return {wanted, room < want ? static_cast<long>((want - room + UNITS_PER_CELL - 1) / UNITS_PER_CELL) : 0};
}

// --- time ---

// Awake, an update is due before the next check would come too late.
bool WaveBasin::is_due(double fastest, double dt, std::int64_t step)
{
  const std::int64_t steps = wait.look(step, pace.every, dt);
  if (fastest >= 0.0)
    travel += std::sqrt(fastest) * static_cast<double>(steps) * dt / shortest;
  else if (moving)
    return true;    // the last solid has just left
  if (is_calm()) return travel >= ASLEEP;
  const double since = wait.time();
  return travel >= pace.stride || since >= pace.period * unit_of_time ||
         since + pace.every * dt > (1.0 + ROUNDING) * LONGEST * unit_of_time;
}

// Advances all of the time since the last update, in parts. Only liquid that slept leaves out the time that it slept.
void WaveBasin::update(const AddBodies &bodies, std::uint64_t)
{
  const bool slept_until_now = sleeps();
  mark_moving(bodies);
  const Lap lap(liquid_seconds);
  const double since = wait.time() / unit_of_time, time = slept_until_now ? std::min(LONGEST, since) : since;
  waves.set_solids(part.data(), mass.data(), since > 0.0 ? time / since : 0.0, &changed);
  changed = CellBox();
  give_impulses(since, since - time);
  const int parts = std::max(1, static_cast<int>(std::ceil(time / LONGEST - ROUNDING)));
  for (int n = 0; n < parts; ++n) go_on(time / parts, parts, n);
  slept += (since - time) * unit_of_time;
  ++updates;
  look();
  if (waves.at_rest())
    find_push(1.0, 0.0);
  else
    find_push(time / (time + SLOW), since);
  travel = 0.0;
  wait.end();
  stale = false;
}

// Exchanges the impulses of solids on the liquid, and of the liquid on them, since the last update. Impulses that liquid gave to
// solids while `asleep` came from the basin.
void WaveBasin::give_impulses(double since, double asleep)
{
  std::vector<std::int64_t> all = from_solids;
  ranks.add_wide(all.data(), static_cast<int>(all.size()));
  const auto middle = all.begin() + columns(), end = middle + columns();
  const auto sum = [](auto from, auto to) {
    return static_cast<double>(std::accumulate(from, to, std::int64_t{0})) * IMPULSE_UNIT;
  };
  // Force in units of the waves: density, g and cell are 1 there, and time is that of a square cell.
  const Vec3 push{static_cast<double>(end[0]) * PUSH_UNIT * shape.cell.y / shape.cell.z,
                  static_cast<double>(end[1]) * PUSH_UNIT * shape.cell.x / shape.cell.z, 0.0};
  account.basin += -asleep * push;
  account.solids += since * push - Vec3{sum(all.begin(), middle), sum(middle, end), 0.0};
  std::vector<double> given(2 * columns());
  for (std::size_t n = 0; n < given.size(); ++n) given[n] = static_cast<double>(all[n]) * IMPULSE_UNIT;
  waves.exchange.add_impulse(given.data(), given.data() + columns());
  std::fill(from_solids.begin(), from_solids.end(), 0);
}

// Part `n` of an update: makers, waves and drops. Drops also lose momentum to walls, and gain some by their scatter.
void WaveBasin::go_on(double time, int parts, int n)
{
  makers.apply(waves, time);
  account.came += waves.take_came();
  gone += waves.update(time, 1.0 / (parts - n)) * unit_of_time;
  const Vec3 lost = waves.take_lost(), flying = drops.momentum();
  drops.update(waves, time, key_of(static_cast<std::uint64_t>(updates), n));
  account.basin += lost - (drops.momentum() - flying) - waves.take_came();
}

// --- what a particle finds ---

// Parts of a lattice cell are half a cell high. Their middles lie half-way from the middle of the cell to its corners.
Basin::OnParts WaveBasin::on_parts(const Vec3 &middle) const
{
  OnParts on;
  if (!(middle.x >= 0.0 && middle.x <= shape.nx && middle.y >= 0.0 && middle.y <= shape.ny)) return on;
  const int x = std::min(static_cast<int>(middle.x), shape.nx - 1), y = std::min(static_cast<int>(middle.y), shape.ny - 1);
  double head = heads[y * shape.nx + x];
  on.share = std::clamp(head, 0.0, 1.0);
  const int number = push.number_of(cell_number(x, y, std::clamp(static_cast<int>(middle.z), 0, shape.nz - 1)));
  if (number >= 0) {
    const WavePush::OnCell &found = push.all()[number];
    head = found.head;
    on.share = found.of[WavePush::OnCell::SHARE];
    on.more = found.of[WavePush::OnCell::OVER] - found.of[WavePush::OnCell::ON_TOP];
    on.beside = found.of[WavePush::OnCell::BESIDE];
    on.along_x = found.of[WavePush::OnCell::ALONG_X] * (shape.cell.z / shape.cell.x);
    on.along_y = found.of[WavePush::OnCell::ALONG_Y] * (shape.cell.z / shape.cell.y);
    on.flow_x = found.of[WavePush::OnCell::FLOW_X] * shape.cell.x / unit_of_time;
    on.flow_y = found.of[WavePush::OnCell::FLOW_Y] * shape.cell.y / unit_of_time;
  }
  on.surface = 2.0 * head - middle.z + 0.5;
  return on;
}

void WaveBasin::find_push(double part, double since)
{
  push.find(waves, afloat.data(), part, since);
  for (int c = 0; c < columns(); ++c)
    rising[c] = {afloat[c].mass > 0.0 ? 1.0 : 0.0, push.is_close(c) ? std::max(0.0, afloat[c].velocity) : afloat[c].velocity};
}

double WaveBasin::calms_solids() const { return CALMING / unit_of_time; }

// Mean of the columns around that hold solids.
double WaveBasin::rising_at(const Vec3 &place) const
{
  const double px = std::clamp(place.x - 0.5, 0.0, shape.nx - 1.0), py = std::clamp(place.y - 0.5, 0.0, shape.ny - 1.0);
  const int x0 = static_cast<int>(px), y0 = static_cast<int>(py);
  const int to_x = x0 + 1 < shape.nx, to_y = y0 + 1 < shape.ny ? shape.nx : 0;    // to the next column, where there is one
  const double u = px - x0, v = py - y0;
  const Rising *const here = &rising[y0 * shape.nx + x0];
  double sum = 0.0, weights = 0.0;
  const auto take = [&](const Rising &of, double weight) {
    sum += weight * of.velocity;
    weights += weight * of.there;
  };
  take(here[0], (1.0 - u) * (1.0 - v));
  take(here[to_x], u * (1.0 - v));
  take(here[to_y], (1.0 - u) * v);
  take(here[to_x + to_y], u * v);
  return weights > 0.0 ? sum / weights * speed_of_waves() : 0.0;
}

// std::llround is a call, and slower.
static std::int64_t whole(double x) { return static_cast<std::int64_t>(x + (x < 0.0 ? -0.5 : 0.5)); }

// `impulse` is divided by the liquid's density.
void WaveBasin::take_impulse(const Vec3 &place, const Vec3 &impulse)
{
  if (!(place.x >= 0.0 && place.x <= shape.nx && place.y >= 0.0 && place.y <= shape.ny)) return;
  const int x = std::min(static_cast<int>(place.x), shape.nx - 1), y = std::min(static_cast<int>(place.y), shape.ny - 1);
  const double unit = cell_volume() / unit_of_time * IMPULSE_UNIT;
  const int column = y * shape.nx + x;
  from_solids[column] += whole(impulse.x / (unit * shape.cell.x));
  from_solids[columns() + column] += whole(impulse.y / (unit * shape.cell.y));
}

void WaveBasin::take_push(const Vec3 &volume_along)
{
  const double unit = cell_volume() * PUSH_UNIT;
  from_solids[2 * columns()] += whole(volume_along.x / unit);
  from_solids[2 * columns() + 1] += whole(volume_along.y / unit);
}

}    // namespace mdanim
