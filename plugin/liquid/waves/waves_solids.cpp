// SPDX-License-Identifier: GPL-2.0-only
// New solids: spans of columns that have changed are cut anew, and liquid is carried over to them.

#include "liquid/waves/columns.h"
#include "liquid/waves/waves.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

namespace mdanim {

namespace {

// A span with a capacity up to this closes; an open one releases the liquid that it cannot hold any more.
constexpr Units MOST_OVERFULL = 2 * UNITS_PER_CELL;

}    // namespace

void Waves::set_solids(const std::uint16_t *part, const double *mass, double again, const CellBox *where)
{
  const std::vector<int> changed = differing(part, where ? *where : CellBox{{0, 0, 0}, {nx, ny, nz}});
  std::fill(walled_anew.begin(), walled_anew.end(), 0);
  if (!changed.empty()) {
    resting = false;
    std::vector<int> columns = changed;
    for (int column = 0; column < nx * ny; ++column)
      if (spans_in[column] > 1) columns.push_back(column);
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    std::vector<SpanState> was;
    for (const int column : columns)
      for (int n = 0; n < spans_in[column]; ++n) was.push_back(state_at(place(column, n)));
    save_further_links();
    for (const int column : changed) {
      const std::size_t lowest = static_cast<std::size_t>(column) * nz;
      std::copy_n(part + lowest, nz, solid.part.begin() + static_cast<std::ptrdiff_t>(lowest));
    }
    find_homes(carry_over(columns, changed, was));
    join(changed);
    if (again != 1.0)
      for (std::size_t i = 0; i < content.size(); ++i) arrays.coming[i] *= again;
  }
  for (int column = 0; column < nx * ny; ++column)
    for (int n = 0; n < spans_in[column]; ++n) {
      double &yields = arrays.yields[place(column, n)];
      const double now = mass && mass[column] > 0.0 ? 1.0 / mass[column] : 0.0;
      if (now != yields) resting = false;
      yields = now;
    }
}

// Spans depend on the columns beside them.
void Waves::cut_anew(int column, std::vector<std::uint8_t> &marks) const
{
  marks[column] = 1;
  for (int side = 0; side < 4; ++side)
    if (const int other = neighbour(column, side, nx, ny); other >= 0) marks[other] = 1;
}

std::vector<int> Waves::differing(const std::uint16_t *part, const CellBox &where) const
{
  std::vector<std::uint8_t> near = walled_anew;
  for (int y = where.low[1]; y < where.high[1]; ++y)
    for (int x = where.low[0]; x < where.high[0]; ++x) {
      const int column = y * nx + x;
      const std::size_t lowest = static_cast<std::size_t>(column) * nz + where.low[2];
      if (std::memcmp(&solid.part[lowest], part + lowest, (where.high[2] - where.low[2]) * sizeof *part) != 0)
        cut_anew(column, near);
    }
  std::vector<int> changed;
  for (int column = 0; column < nx * ny; ++column)
    if (near[column]) changed.push_back(column);
  return changed;
}

Waves::SpanState Waves::state_at(long i) const
{
  const double level = arrays.full[i] > 0.0 ? span[i].roof : head_of(solid, span[i], content[i]).height;
  return {span[i],         content[i],           level,           arrays.full[i], arrays.rest[i], arrays.phi[i],
          arrays.delta[i], arrays.last_delta[i], arrays.coming[i]};
}

void Waves::put(long i, const SpanState &state)
{
  span[i] = state.span;
  content[i] = state.content;
  arrays.capacity[i] = state.span.column < 0 ? WaveArrays::NOWHERE : static_cast<double>(state.span.capacity) / UNITS_PER_CELL;
  arrays.floor[i] = state.span.floor;
  arrays.roof[i] = state.span.roof;
  arrays.full[i] = state.full;
  arrays.rest[i] = state.rest;
  arrays.phi[i] = state.phi;
  arrays.delta[i] = state.delta;
  arrays.last_delta[i] = state.last_delta;
  arrays.coming[i] = state.coming;
}

// Cuts those of the columns that have changed, and gives their liquid to their new spans. Further spans of all columns move up.
// Returns liquid that has lost its span.
std::vector<Waves::Homeless> Waves::carry_over(const std::vector<int> &columns, const std::vector<int> &changed,
                                               const std::vector<SpanState> &was)
{
  std::vector<Homeless> homeless;
  std::vector<SpanState> further_spans;
  std::vector<Span> cut;
  std::size_t next_changed = 0, next_old = 0;
  for (const int column : columns) {
    const std::vector<SpanState> old(was.begin() + next_old, was.begin() + next_old + spans_in[column]);
    next_old += old.size();
    std::vector<SpanState> now = old;
    if (next_changed < changed.size() && changed[next_changed] == column) {
      ++next_changed;
      cut.clear();
      cut_column(solid, wall, column, cut);
      now = share_out(old, cut, homeless);
    }
    spans_in[column] = static_cast<int>(now.size());
    further[column] = static_cast<int>(further_spans.size());
    put(place(column), now.empty() ? NO_SPAN : now[0]);
    if (now.size() > 1) further_spans.insert(further_spans.end(), now.begin() + 1, now.end());
  }
  const long rows = (static_cast<long>(further_spans.size()) + stride - 1) / stride;
  const long last = std::max(rows, further_rows) * stride;
  lay_out(rows, 0);
  for (long n = 0; n < last; ++n)
    put(further_start + n, n < static_cast<long>(further_spans.size()) ? further_spans[n] : NO_SPAN);
  return homeless;
}

// Carries liquid from the old spans of a column to its new ones. As many as before, in the same order, continue; where spans
// split or join, liquid goes by the layers in which it stood.
std::vector<Waves::SpanState> Waves::share_out(const std::vector<SpanState> &was, const std::vector<Span> &cut,
                                               std::vector<Homeless> &homeless) const
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
      pour(to, static_cast<Units>(volume_below(solid, to.span, old.level) * UNITS_PER_CELL));
      to.phi = to.rest = std::max(to.span.floor, old.phi);
      to.full = std::max(to.full, old.full > 0.0 && old.phi >= to.span.roof ? 1.0 : 0.0);
    }
    for (SpanState &to : now)
      if (to.span.overlaps(old.span)) pour(to, left);
    if (left > 0) homeless.push_back({old.span.column, std::min(old.span.high - 1, static_cast<int>(old.level)), left});
  }
  for (SpanState &to : now) {
    if (to.content < to.span.capacity - UNITS_PER_CELL) to.full = 0.0;    // as in (W1)
    if (to.content > to.span.capacity + MOST_OVERFULL) {
      homeless.push_back({to.span.column, to.span.high - 1, to.content - to.span.capacity});
      to.content = to.span.capacity;
    }
  }
  return now;
}

// Finds room in the nearest columns: first in spans at the height of the liquid, then in any.
void Waves::find_homes(const std::vector<Homeless> &homeless)
{
  for (const Homeless &from : homeless) {
    Units left = from.units;
    const int column_x = from.column % nx, column_y = from.column / nx;
    const auto offer = [&](int x, int y, bool at_height) {
      if (x < 0 || x >= nx || y < 0 || y >= ny) return;
      const int column = y * nx + x;
      for (int n = 0; n < spans_in[column] && left > 0; ++n) {
        const long i = place(column, n);
        if (at_height && (span[i].low > from.z || span[i].high <= from.z)) continue;
        const Units taken = std::clamp<Units>(span[i].capacity - content[i], 0, left);
        content[i] += taken;
        left -= taken;
        counts.displaced += taken;
      }
    };
    for (const bool at_height : {true, false})
      for (int ring = 0; ring < std::max(nx, ny) && left > 0; ++ring)
        for (int y = -ring; y <= ring; ++y)
          for (int x = -ring; x <= ring; x += std::abs(y) == ring || ring == 0 ? 1 : 2 * ring)
            if (left > 0) offer(column_x + x, column_y + y, at_height);
    if (left > 0)
      throw std::runtime_error("a solid closes cell (" + std::to_string(column_x) + ", " + std::to_string(column_y) + ", " +
                               std::to_string(from.z) + ") of the basin and there is no room for the " + std::to_string(left) +
                               " units of liquid in it; enlarge the basin or lower the liquid's level");
  }
}

}    // namespace mdanim
