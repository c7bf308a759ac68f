// SPDX-License-Identifier: GPL-2.0-only
// The pressure of spans on the solid runs between them.

#include "liquid/waves/wave_push.h"

#include "liquid/waves/columns.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

namespace {

constexpr int LEAST_PART = SolidParts::FULL / 8;    // a cell with a smaller solid part gets the values of its neighbours
constexpr int HALF = SolidParts::FULL / 2;          // a cell with a smaller solid part hides no surface
constexpr double NARROW = 1.0;                      // gaps below bodies that cells do not resolve: liquid seeps in
constexpr double HIGHEST = 8.0;    // cells of liquid: greatest pressure on a body beyond that of the liquid around it
constexpr int SMOOTHINGS = 4;
bool is_narrow(const WaveExchange::SpanView &span) { return span.capacity <= NARROW; }
// A gap beside the face of a wall, where cells are nearly full, is a part of the wall.
bool is_crack(const WaveExchange::SpanView &span) { return is_narrow(span) && span.roof - span.floor > NARROW; }

// The head of liquid that seeps below a run is between those around, which push the run up to their mean: the part of the run
// that this is, over that below its own head.
double pushed(double bottom, double top, double mean, double own)
{
  const auto wet = [&](double head) { return std::clamp(head, bottom, top) - bottom; };
  return wet(own) > 0.0 ? std::min(2.0, wet(mean) / wet(own)) : 1.0;
}

constexpr double HIDDEN = std::numeric_limits<double>::quiet_NaN();

}    // namespace

void WavePush::find(const Waves &waves, const AddedMass::Solids *solids, double part, double since)
{
  for (const std::size_t cell : cells) known[cell] = -1;
  found.clear();
  cells.clear();
  runs.clear();
  columns.clear();
  first_run.assign(static_cast<std::size_t>(nx) * ny, -1);
  for (int column = 0; column < nx * ny; ++column)
    if (solids[column].mass > 0.0) {
      columns.push_back(column);
      cut(waves, column);
    }
  seep(waves);
  follow(waves, part);
  find_close(waves);
  take_along(waves, solids, since);
  for (SolidRun &run : runs) press(waves, run);
  for (const int column : columns) fill(waves, column);
  spread(waves.solids());
}

void WavePush::cut(const Waves &waves, int column)
{
  const int spans = waves.exchange.spans_of(column);
  first_run[column] = static_cast<int>(runs.size());
  double bottom = 0.0;
  for (int n = 0; n <= spans; ++n) {
    SolidRun run{};
    run.column = column;
    run.below = n - 1;
    run.above = n < spans ? n : -1;
    run.bottom = bottom;
    run.top = nz;
    if (n < spans) {
      const WaveExchange::SpanView above = waves.exchange.span_view(column, n);
      run.top = above.floor;
      bottom = above.roof;
    }
    run.floor = run.bottom;
    if (run.below >= 0) {
      const WaveExchange::SpanView below = waves.exchange.span_view(column, run.below);
      run.told = !is_narrow(below);
      run.wet = run.told && below.wet;
      run.phi = below.phi;
      run.floor = below.floor;
    }
    runs.push_back(run);    // one above each span and one below the lowest; some are empty
  }
  // Runs parted by a crack are one run.
  for (int first = 0, last = 0; first <= spans; first = ++last) {
    while (last < spans && is_crack(waves.exchange.span_view(column, last))) ++last;
    SolidRun *const of_column = &runs[first_run[column]];
    of_column[first].top = of_column[last].top;
    of_column[first].above = of_column[last].above;
    for (int n = first + 1; n <= last; ++n) of_column[n] = of_column[first];
  }
}

// Head of the liquid beside a run, in another column. Liquid that does not reach down to the gap below the run counts where it
// stands over the run: liquid in a hull, held by its wall, takes nothing off the pressure below it. Nor does another gap: liquid
// seeps into it, too.
bool WavePush::beside(const Waves &waves, int column, double bottom, double top, double &phi) const
{
  bool any = false;
  for (int n = 0; n < waves.exchange.spans_of(column); ++n) {
    const WaveExchange::SpanView span = waves.exchange.span_view(column, n);
    if (span.floor >= top || span.roof <= bottom || is_narrow(span)) continue;
    if (span.floor >= bottom + NARROW && (span.volume < ON_BODY || span.phi < top)) continue;
    if (!any || span.wet) phi = span.wet ? span.phi : span.floor;
    any = true;
    if (span.wet) return true;
  }
  if (any || first_run[column] < 0) return any;
  for (int n = 0; n <= waves.exchange.spans_of(column); ++n) {
    const SolidRun &run = runs[first_run[column] + n];
    if (run.bottom >= top || run.top <= bottom || !run.told) continue;
    phi = run.wet ? run.phi : run.floor;
    return true;
  }
  return false;
}

// Liquid seeps below a body that stands on another: its head there is between those around.
void WavePush::seep(const Waves &waves)
{
  std::vector<int> dry;
  for (std::size_t n = 0; n < runs.size(); ++n)
    if (!runs[n].told && runs[n].top > runs[n].bottom) dry.push_back(static_cast<int>(n));
  const auto mean = [&](const SolidRun &run, double &phi) {
    double sum = 0.0;
    int count = 0;
    for (int side = 0; side < 4; ++side) {
      const int other = neighbour(run.column, side, nx, ny);
      double there = 0.0;
      if (other < 0 || !beside(waves, other, run.bottom, run.top, there)) continue;
      sum += std::max(there, run.bottom);
      ++count;
    }
    if (count > 0) phi = sum / count;
    return count > 0;
  };
  learn_inward(
      dry, [&](int n) { return mean(runs[n], runs[n].phi); }, [&](int n) { runs[n].told = runs[n].wet = runs[n].seeps = true; });
  for (int pass = 0; pass < SMOOTHINGS; ++pass)
    for (const int n : dry)
      if (runs[n].told) mean(runs[n], runs[n].phi);
}

// Head of the surface as visible from above; NaN where a body hides it or breaks it.
double WavePush::seen_at(const Waves &waves, int column) const
{
  const int spans = waves.exchange.spans_of(column);
  if (spans == 0) return HIDDEN;
  if (first_run[column] < 0) {
    for (int n = spans - 1; n >= 0; --n)
      if (const WaveExchange::SpanView span = waves.exchange.span_view(column, n); span.wet) return span.phi;
    return waves.exchange.span_view(column, 0).floor;
  }
  const WaveExchange::SpanView top = waves.exchange.span_view(column, spans - 1);
  if (top.high < nz || !top.wet || top.volume < ON_BODY) return HIDDEN;
  for (int z = top.low + 1; z < nz && z < top.phi; ++z)
    if (waves.solids().at(column, z) >= HALF) return HIDDEN;
  return top.phi;
}

// Head around bodies, as it acts sideways: where they hide the surface, it is between those around.
void WavePush::follow(const Waves &waves, double part)
{
  std::vector<double> was(ambient.size(), HIDDEN);
  was.swap(ambient);
  std::vector<std::uint8_t> looked(ambient.size(), 0);
  std::vector<int> hidden;
  const auto take = [&](int column) {
    if (column < 0 || looked[column]) return;
    looked[column] = 1;
    const double now = seen_at(waves, column);
    ambient[column] = std::isnan(was[column]) || std::isnan(now) ? now : was[column] + part * (now - was[column]);
    if (std::isnan(now)) hidden.push_back(column);
  };
  for (const int column : columns) {
    take(column);
    for (int side = 0; side < 4; ++side) take(neighbour(column, side, nx, ny));
  }
  fill_inward(ambient, hidden, nx, ny);
  for (int pass = 0; pass < SMOOTHINGS; ++pass)
    for (const int column : hidden) {
      const double mean = mean_beside(ambient, column, nx, ny);
      if (!std::isnan(mean)) ambient[column] = mean;
    }
}

void WavePush::find_close(const Waves &waves)
{
  std::fill(close.begin(), close.end(), 0);
  for (const int column : columns) {
    int solid_runs = 0, seeping = 0;
    for (int n = 0; n <= waves.exchange.spans_of(column); ++n) {
      const SolidRun &run = runs[first_run[column] + n];
      solid_runs += run.top > run.bottom;
      seeping += run.seeps;
    }
    close[column] = solid_runs > 0 && seeping == solid_runs;
  }
}

// The liquid below and above the topmost run of each column that is wet from below.
void WavePush::take_along(const Waves &waves, const AddedMass::Solids *solids, double since)
{
  std::fill(depths.begin(), depths.end(), AddedMass::Depths{});
  for (const int column : columns)
    for (int n = waves.exchange.spans_of(column); n >= 0; --n) {
      SolidRun &run = runs[first_run[column] + n];
      if (run.below < 0 || !run.wet || run.top <= run.bottom || !waves.exchange.span_view(column, run.below).full) continue;
      run.moves = true;
      depths[column] = {run.bottom - run.floor, 0.0, run.bottom};
      if (run.above < 0) break;
      const WaveExchange::SpanView above = waves.exchange.span_view(column, run.above);
      if (above.wet) depths[column].above = std::max(0.0, above.phi - run.top);
      break;
    }
  if (since > 0.0)
    added.follow(columns, depths.data(), solids, since);
  else
    added.start(columns, depths.data(), solids);
}

void WavePush::press(const Waves &waves, SolidRun &run)
{
  const double thickness = run.top - run.bottom;
  if (!(thickness > 0.0)) return;
  if (run.below >= 0 && waves.exchange.span_view(run.column, run.below).wet)
    std::copy_n(waves.exchange.around(run.column, run.below).u, 4, run.u);
  else if (run.above >= 0)
    std::copy_n(waves.exchange.around(run.column, run.above).u, 4, run.u);
  if (run.above < 0) return;
  const double around = std::max(0.0, ambient[run.column] - run.top);    // 0 where it is unknown
  const auto pressing = [&](double head) { return std::clamp(head - run.top, 0.0, around + HIGHEST) / thickness; };
  if (run.wet) run.beside = around / thickness;
  if (run.wet) run.over = pressing(run.phi);
  const WaveExchange::SpanView above = waves.exchange.span_view(run.column, run.above);
  const SolidRun &upper = runs[first_run[run.column] + run.above + 1];
  if (upper.seeps)
    run.on_top = pressing(upper.phi);
  else if (above.wet)
    run.on_top = pressing(above.phi);
  run.beside -= run.on_top;
  if (run.moves) run.over += added.force_on(run.column) / thickness;
}

// The rise of a head across a face acts on the solid parts on both sides of it.
void WavePush::put(const SolidParts &solid, int column, int z, const SolidRun *stands, OnCell on)
{
  const auto rise = [&](int side) {
    const int other = neighbour(column, side, nx, ny);
    if (other < 0 || std::isnan(ambient[other]) || std::isnan(ambient[column])) return 0.0;
    const double both = (solid.at(column, z) + solid.at(other, z)) / static_cast<double>(SolidParts::FULL);
    const double share = stands ? pushed(stands->bottom, stands->top, 0.5 * (ambient[other] + ambient[column]), on.head) : 1.0;
    return share * std::clamp(ambient[other] - ambient[column], -HIGHEST, HIGHEST) / std::max(1.0, both);
  };
  on.of[OnCell::ALONG_X] = rise(0) - rise(1);
  on.of[OnCell::ALONG_Y] = rise(2) - rise(3);
  if (found.empty() || !(found.back() == on)) found.push_back(on);
  cells.push_back(static_cast<std::size_t>(z) * nx * ny + column);
  known[cells.back()] = static_cast<int>(found.size()) - 1;
}

void WavePush::fill(const Waves &waves, int column)
{
  const SolidParts &solid = waves.solids();
  const auto of_run = [&](int z, const SolidRun &run) {
    OnCell on;
    on.head = run.phi;
    on.of[OnCell::SHARE] = run.wet ? std::clamp(run.phi - run.floor, 0.0, 1.0) : 0.0;
    on.of[OnCell::OVER] = run.over;
    on.of[OnCell::BESIDE] = run.beside;
    on.of[OnCell::ON_TOP] = run.on_top;
    on.of[OnCell::FLOW_X] = 0.5 * (run.u[0] + run.u[1]);
    on.of[OnCell::FLOW_Y] = 0.5 * (run.u[2] + run.u[3]);
    put(solid, column, z, run.seeps ? &run : nullptr, on);
  };
  const SolidRun *run = &runs[first_run[column]];
  int z = 0;
  for (int n = 0; n < waves.exchange.spans_of(column); ++n, ++run) {
    const WaveExchange::SpanView span = waves.exchange.span_view(column, n);
    for (const int end = is_crack(span) ? span.high : span.low; z < end; ++z)
      if (solid.at(column, z) >= LEAST_PART) of_run(z, *run);
    bool looked = false;
    WaveExchange::Sides sides{};
    for (; z < span.high; ++z) {
      if (solid.at(column, z) < LEAST_PART) continue;
      if (z == span.low && span.floor > z) {
        of_run(z, *run);
        continue;
      }
      if (z == span.high - 1 && span.roof < z + 1.0) {
        of_run(z, run[1]);
        continue;
      }
      if (!looked) sides = waves.exchange.around(column, n);
      looked = true;
      OnCell on;
      on.head = span.phi;
      on.of[OnCell::SHARE] = span.wet ? std::clamp(span.phi - span.floor, 0.0, 1.0) : 0.0;
      on.of[OnCell::FLOW_X] = 0.5 * (sides.u[0] + sides.u[1]);
      on.of[OnCell::FLOW_Y] = 0.5 * (sides.u[2] + sides.u[3]);
      put(solid, column, z, nullptr, on);
    }
  }
  for (; z < nz; ++z)
    if (solid.at(column, z) >= LEAST_PART) of_run(z, *run);
}

// Whether a cell and all around it are among the first `own`.
bool WavePush::is_among(std::size_t own, int x, int y, int z) const
{
  if (x < 1 || x + 1 >= nx || y < 1 || y + 1 >= ny || z < 1 || z + 1 >= nz) return false;
  bool all = true;
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy) {
      const int *const row = &known[(static_cast<std::size_t>(z + dz) * ny + y + dy) * nx + x];
      for (int dx = -1; dx <= 1; ++dx) all = all && static_cast<unsigned>(row[dx]) < own;
    }
  return all;
}

// Cells next to bodies get the mean of the known values around them.
void WavePush::spread(const SolidParts &solid)
{
  next_to.clear();
  const std::size_t own = found.size(), layer = static_cast<std::size_t>(nx) * ny, many = cells.size();
  for (std::size_t n = 0; n < many; ++n) {
    const int column = static_cast<int>(cells[n] % layer);
    const int z = static_cast<int>(cells[n] / layer), x = column % nx, y = column / nx;
    if (is_among(own, x, y, z)) continue;
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (x + dx < 0 || x + dx >= nx || y + dy < 0 || y + dy >= ny || z + dz < 0 || z + dz >= nz) continue;
          const std::size_t cell = (static_cast<std::size_t>(z + dz) * ny + y + dy) * nx + x + dx;
          int &number = known[cell];
          if (number >= 0 && number < static_cast<int>(own)) continue;
          if (number < 0) {
            number = static_cast<int>(own + next_to.size());
            next_to.push_back({{}, 0.0, 0.0, cell});
          }
          NextTo &sum = next_to[number - own];
          const OnCell &from = found[known[cells[n]]];
          const double weight = solid.at(column, z) * (dx ? 0.5 : 1.0) * (dy ? 0.5 : 1.0) * (dz ? 0.5 : 1.0);
          sum.weight += weight;
          for (int k = 0; k < OnCell::NUMBERS; ++k) sum.on.of[k] += weight * from.of[k];
          if (from.of[OnCell::SHARE] > 0.0) {
            sum.wet += weight;
            sum.on.head += weight * from.head;
          }
        }
  }
  for (NextTo &sum : next_to) {
    OnCell &on = sum.on;
    if (sum.wet > 0.0) on.head /= sum.wet;
    for (double &value : on.of) value /= sum.weight;
    found.push_back(on);
    cells.push_back(sum.cell);
  }
}

}    // namespace mdanim
