// SPDX-License-Identifier: GPL-2.0-only
// Times of updates of waves, the solid parts of the basin, and the liquid at a particle.

#include "liquid/waves/wave_basin.h"

#include "liquid/waves/wave_fill.h"
#include "numbers/stopwatch.h"

#include <climits>
#include <cmath>
#include <cstdio>

namespace mdanim {

namespace {

constexpr double SAMPLED = 4.0;    // cells above the liquid up to which solids are marked
constexpr double LONGEST = 0.2;    // time that the liquid advances at once, in sqrt(cell/g)
constexpr double ROUNDING = 1e-9;
constexpr double ASLEEP = 1.0 / 64.0;    // cells that a solid may go before liquid at rest is updated
constexpr double SLOW = 1.0;             // time constant of the sideways push, in sqrt(cell/g)
constexpr double CALMING = 1.0;          // rate at which columns of solids lose their vibration, in sqrt(g/cell)
constexpr double FLATTEST = 1.25;        // longest edge of a cell over the shortest

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

WaveBasin::WaveBasin(const Shape &shape, double g, const WaveSettings &settings, const RankSums &ranks)
    : Basin(shape, g, ranks), unit_of_time(std::sqrt(shape.cell.x * shape.cell.y / (g * shape.cell.z))),
      waves(shape.nx, shape.ny, shape.nz), solids(shape.nx, shape.ny, shape.nz), from_solids(shape, unit_of_time),
      push(shape.nx, shape.ny, shape.nz), makers(shape.nx, shape.ny), drops(shape.nx, shape.ny, settings.seed),
      heights(shape.nx, shape.ny), rising(columns())
{
  waves.run.law.calm = settings.calm * unit_of_time;
  waves.run.law.bed = bed_friction(settings.manning, g, std::sqrt(shape.cell.x * shape.cell.y), shape.cell.z);
  drops.share = settings.spray;
}

void WaveBasin::accelerate(const Vec3 &mean)
{
  const double per_g = 1.0 / (g * shape.cell.z);
  waves.tilt(per_g * mean.x * shape.cell.x, per_g * mean.y * shape.cell.y);
}

// --- makers of waves ---

void WaveBasin::add_wave(int side, double amplitude, double period, double depth)
{ makers.add_paddle(static_cast<SideOf>(side), amplitude / shape.cell.z, period / unit_of_time, depth / shape.cell.z); }

void WaveBasin::add_current(int side, double speed)
{
  const double cell = side == WEST || side == EAST ? shape.cell.x : shape.cell.y;
  makers.add_current(static_cast<SideOf>(side), speed * unit_of_time / cell);
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

// --- solids, and the start ---

long WaveBasin::mark_still(const AddBodies &bodies)
{
  const Lap lap(occupancy_seconds);
  return solids.mark_still(bodies, ranks, threads, waves);
}

// Solids above the basin have no place in the liquid.
void WaveBasin::mark_moving(const AddBodies &bodies)
{
  const Lap lap(occupancy_seconds);
  solids.mark_moving(bodies, poured ? top() + SAMPLED : shape.nz, std::min(pace.period, LONGEST), ranks, threads);
}

Basin::Filled WaveBasin::fill(const Amount &amount, const std::vector<std::uint8_t> &within, std::uint64_t when)
{
  solids.give_to(waves);
  const Filled filled = fill_with(waves, *this, amount, within, [this](int column, int z) { return solids.floats(column, z); });
  if (filled.wanted < 1) return filled;
  units = waves.total();
  energy_at_start = energy_now();
  poured = true;
  stale = true;    // so that the first check updates
  wait.looked = static_cast<std::int64_t>(when);
  find_heights();
  find_push(1.0, 0.0);
  return filled;
}

// --- time ---

// Awake, an update is due before the next check would come too late.
bool WaveBasin::is_due(double fastest, double dt, std::int64_t step)
{
  const std::int64_t steps = wait.look(step, pace.every, dt);
  if (fastest >= 0.0)
    travel += std::sqrt(fastest) * static_cast<double>(steps) * dt / shortest;
  else if (moving_solid())
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
  solids.give_to(waves, since > 0.0 ? time / since : 0.0);
  give_impulses(since, since - time);
  const int parts = std::max(1, static_cast<int>(std::ceil(time / LONGEST - ROUNDING)));
  for (int n = 0; n < parts; ++n) go_on(time / parts, parts, n);
  slept += (since - time) * unit_of_time;
  ++updates;
  find_heights();
  if (waves.at_rest())
    find_push(1.0, 0.0);
  else
    find_push(time / (time + SLOW), since);
  travel = 0.0;
  wait.end();
  stale = false;
}

// Impulses between solids and liquid since the last update. Those that liquid gave to solids while `asleep` came from the basin.
void WaveBasin::give_impulses(double since, double asleep)
{
  const SolidImpulses::Totals sums = from_solids.sum_over(ranks);
  account.basin += -asleep * sums.push;
  account.solids += since * sums.push - sums.all_given;
  waves.exchange.add_impulse(sums.given.data(), sums.given.data() + columns());
  from_solids.clear();
}

// Part `n` of an update: makers, waves and drops. Drops also lose momentum to walls, and gain some by their scatter.
void WaveBasin::go_on(double time, int parts, int n)
{
  makers.apply(waves, time);
  account.came += waves.take_came();
  gone += waves.update(time, 1.0 / (parts - n)) * unit_of_time;
  account.came -= waves.take_left_behind();
  account.outer += g * shape.cell.z * cell_volume() * (waves.take_brought() - waves.take_climbed());
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
  on.flow_x = speed.x, on.flow_y = speed.y;
  double head = heights.head(y * shape.nx + x);
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
    on.flow_x += found.of[WavePush::OnCell::FLOW_X] * shape.cell.x / unit_of_time;
    on.flow_y += found.of[WavePush::OnCell::FLOW_Y] * shape.cell.y / unit_of_time;
  }
  on.surface = 2.0 * head - middle.z + 0.5;
  return on;
}

void WaveBasin::find_push(double part, double since)
{
  const std::vector<AddedMass::Solids> &afloat = solids.now().afloat;
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

}    // namespace mdanim
