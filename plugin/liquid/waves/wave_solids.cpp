// SPDX-License-Identifier: GPL-2.0-only
// New solids: spans of columns that have changed are cut anew, and liquid is carried over to them.

#include "liquid/waves/wave_solids.h"

#include "liquid/waves/columns.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <stdexcept>
#include <string>

namespace mdanim {

// A span with a capacity up to this closes; an open one releases the liquid that it cannot hold any more.
static constexpr Units MOST_OVERFULL = 2 * UNITS_PER_CELL;

WaveSolids::WaveSolids(WaveColumns &columns, WaveRun &run)
    : columns(columns), run(run), arrays(columns.arrays), span(columns.span), content(columns.content),
      walled_anew(columns.nx * columns.ny, 0)
{
  std::vector<int> all(columns.nx * columns.ny);
  std::iota(all.begin(), all.end(), 0);
  carry_over(all, all, {});
  columns.join(all);
}

void WaveSolids::set_solids(const std::uint16_t *part, const double *mass, double again, const CellBox *where)
{
  const std::vector<int> changed = differing(part, where ? *where : CellBox{{0, 0, 0}, {columns.nx, columns.ny, columns.nz}});
  std::fill(walled_anew.begin(), walled_anew.end(), 0);
  if (!changed.empty()) {
    run.resting = false;
    std::vector<int> those = changed;
    for (int column = 0; column < columns.nx * columns.ny; ++column)
      if (columns.spans_in[column] > 1) those.push_back(column);
    std::sort(those.begin(), those.end());
    those.erase(std::unique(those.begin(), those.end()), those.end());
    std::vector<SpanState> was;
    for (const int column : those)
      for (int n = 0; n < columns.spans_in[column]; ++n) was.push_back(columns.state_at(columns.place(column, n)));
    columns.save_further_links();
    for (const int column : changed) {
      const std::size_t lowest = static_cast<std::size_t>(column) * columns.nz;
      std::copy_n(part + lowest, columns.nz, columns.solid.part.begin() + static_cast<std::ptrdiff_t>(lowest));
    }
    place_displaced(carry_over(those, changed, was));
    columns.join(changed);
    if (again != 1.0)
      for (std::size_t i = 0; i < content.size(); ++i) arrays.coming[i] *= again;
  }
  for (int column = 0; column < columns.nx * columns.ny; ++column)
    for (int n = 0; n < columns.spans_in[column]; ++n) {
      double &yields = arrays.yields[columns.place(column, n)];
      const double now = mass && mass[column] > 0.0 ? 1.0 / mass[column] : 0.0;
      if (now != yields) run.resting = false;
      yields = now;
    }
}

// Spans depend on the columns beside them.
void WaveSolids::cut_anew(int column, std::vector<std::uint8_t> &marks) const
{
  marks[column] = 1;
  for (int side = 0; side < 4; ++side)
    if (const int other = neighbour(column, side, columns.nx, columns.ny); other >= 0) marks[other] = 1;
}

std::vector<int> WaveSolids::differing(const std::uint16_t *part, const CellBox &where) const
{
  std::vector<std::uint8_t> near = walled_anew;
  for (int y = where.low[1]; y < where.high[1]; ++y)
    for (int x = where.low[0]; x < where.high[0]; ++x) {
      const int column = y * columns.nx + x;
      const std::size_t lowest = static_cast<std::size_t>(column) * columns.nz + where.low[2];
      if (std::memcmp(&columns.solid.part[lowest], part + lowest, (where.high[2] - where.low[2]) * sizeof *part) != 0)
        cut_anew(column, near);
    }
  std::vector<int> changed;
  for (int column = 0; column < columns.nx * columns.ny; ++column)
    if (near[column]) changed.push_back(column);
  return changed;
}

// Cuts those of the columns that have changed, and gives their liquid to their new spans. Further spans of all columns move up.
// Returns liquid that has lost its span.
std::vector<WaveSolids::Displaced> WaveSolids::carry_over(const std::vector<int> &those, const std::vector<int> &changed,
                                                          const std::vector<SpanState> &was)
{
  std::vector<Displaced> displaced;
  std::vector<SpanState> further_spans;
  std::vector<Span> cut;
  std::size_t next_changed = 0, next_old = 0;
  for (const int column : those) {
    const std::vector<SpanState> old(was.begin() + next_old, was.begin() + next_old + columns.spans_in[column]);
    next_old += old.size();
    std::vector<SpanState> now = old;
    if (next_changed < changed.size() && changed[next_changed] == column) {
      ++next_changed;
      cut.clear();
      cut_column(columns.solid, columns.wall, column, cut);
      now = share_out(old, cut, displaced);
    }
    columns.spans_in[column] = static_cast<int>(now.size());
    columns.further[column] = static_cast<int>(further_spans.size());
    columns.put(columns.place(column), now.empty() ? WaveColumns::NO_SPAN : now[0]);
    if (now.size() > 1) further_spans.insert(further_spans.end(), now.begin() + 1, now.end());
  }
  const long rows = (static_cast<long>(further_spans.size()) + columns.stride - 1) / columns.stride;
  const long last = std::max(rows, columns.further_rows) * columns.stride;
  columns.lay_out(rows, 0);
  for (long n = 0; n < last; ++n)
    columns.put(columns.further_start + n, n < static_cast<long>(further_spans.size()) ? further_spans[n] : WaveColumns::NO_SPAN);
  return displaced;
}

// Carries liquid from the old spans of a column to its new ones. As many as before, in the same order, continue; where spans
// split or join, liquid goes by the layers in which it stood.
std::vector<WaveColumns::SpanState> WaveSolids::share_out(const std::vector<SpanState> &was, const std::vector<Span> &cut,
                                                          std::vector<Displaced> &displaced) const
{
  std::vector<SpanState> now;
  for (const Span &s : cut) now.push_back({s, 0, s.floor, 0.0, s.floor, s.floor, 0.0, 0.0, 0.0});
  bool same = was.size() == now.size();
  for (std::size_t n = 0; same && n < was.size(); ++n) same = was[n].span.overlaps(now[n].span);
  for (std::size_t n = 0; n < was.size(); ++n) {
    const SpanState &old = was[n];
    if (same) {
      now[n] = old;
      now[n].span = cut[n];
      now[n].coming = static_cast<double>(cut[n].capacity - old.span.capacity) / UNITS_PER_CELL;
      continue;
    }
    Units left = old.content;
    const auto pour = [&](SpanState &to, Units most) {
      const Units taken = std::clamp<Units>(std::min(most, to.span.capacity - to.content), 0, left);
      to.content += taken;
      left -= taken;
    };
    for (SpanState &to : now) {
      if (!to.span.overlaps(old.span)) continue;
      pour(to, static_cast<Units>(volume_below(columns.solid, to.span, old.level) * UNITS_PER_CELL));
      to.phi = to.rest = std::max(to.span.floor, old.phi);
      to.full = std::max(to.full, old.full > 0.0 && old.phi >= to.span.roof ? 1.0 : 0.0);
    }
    for (SpanState &to : now)
      if (to.span.overlaps(old.span)) pour(to, left);
    if (left > 0) displaced.push_back({old.span.column, std::min(old.span.high - 1, static_cast<int>(old.level)), left});
  }
  for (SpanState &to : now) {
    if (to.content < to.span.capacity - UNITS_PER_CELL) to.full = 0.0;    // as in (W1)
    if (to.content > to.span.capacity + MOST_OVERFULL) {
      displaced.push_back({to.span.column, to.span.high - 1, to.content - to.span.capacity});
      to.content = to.span.capacity;
    }
  }
  return now;
}

// Finds room in the nearest columns: first in spans at the height of the liquid, then in any.
void WaveSolids::place_displaced(const std::vector<Displaced> &displaced)
{
  for (const Displaced &from : displaced) {
    Units left = from.units;
    const int column_x = from.column % columns.nx, column_y = from.column / columns.nx;
    const auto offer = [&](int x, int y, bool at_height) {
      if (x < 0 || x >= columns.nx || y < 0 || y >= columns.ny) return;
      const int column = y * columns.nx + x;
      const long lowest = (1 + y) * columns.stride + x;
      for (int n = 0; n < columns.spans_in[column] && left > 0; ++n) {
        const long i = n == 0 ? lowest : columns.place(column, n);
        if (content[i] >= span[i].capacity || (at_height && (span[i].low > from.z || span[i].high <= from.z))) continue;
        const Units taken = std::min(span[i].capacity - content[i], left);
        content[i] += taken;
        left -= taken;
        run.counts.displaced += taken;
      }
    };
    for (const bool at_height : {true, false})
      for (int ring = 0; ring < std::max(columns.nx, columns.ny) && left > 0; ++ring)
        for (int y = -ring; y <= ring; ++y)
          for (int x = -ring; x <= ring; x += std::abs(y) == ring || ring == 0 ? 1 : 2 * ring)
            if (left > 0) offer(column_x + x, column_y + y, at_height);
    if (left > 0)
      throw std::runtime_error("a solid closes cell (" + std::to_string(column_x) + ", " + std::to_string(column_y) + ", " +
                               std::to_string(from.z) + ") of the basin and there is no room for the " + std::to_string(left) +
                               " units of liquid in it; enlarge the basin or lower the liquid's level");
  }
}

void WaveSolids::set_walls(const std::uint16_t *held)
{
  for (int column = 0; column < columns.nx * columns.ny; ++column) {
    std::uint16_t *const own = &columns.wall.part[static_cast<std::size_t>(column) * columns.nz];
    const std::uint16_t *const now = held + static_cast<std::size_t>(column) * columns.nz;
    if (std::equal(now, now + columns.nz, own)) continue;
    std::copy_n(now, columns.nz, own);
    cut_anew(column, walled_anew);
  }
}

}    // namespace mdanim
