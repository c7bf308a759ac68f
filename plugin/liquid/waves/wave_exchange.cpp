// SPDX-License-Identifier: GPL-2.0-only
// Liquid that comes and goes.

#include "liquid/waves/wave_exchange.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

// The span that holds a height, or else the next one below it; the lowest where there is none. Negative without spans.
int WaveExchange::span_below(int column, double height) const
{
  int n = columns.spans_in[column] - 1;
  while (n > 0 && span[columns.place(column, n)].floor > height) --n;
  return n;
}

// Height to which a link of a span with this head is filled by the present contents of the spans: wetted heights belong to the
// last update, and are not a part of the state.
double WaveExchange::filled(const LinkPlace &link, double head, long other) const
{
  if (!columns.is_link(link)) return 0.0;
  return std::max(0.0, columns.opening(link, std::max(head, head_of(columns.solid, span[other], content[other]).height)));
}

Units WaveExchange::give(int column, double height, Units units, double ux, double uy)
{
  const int n = span_below(column, height);
  if (n < 0) return 0;
  const long i = columns.place(column, n);
  const Units taken = std::clamp<Units>(span[i].capacity - content[i], 0, units);
  if (taken == 0) return 0;
  run.resting = false;
  run.brought -= moment_of(columns.solid, span[i], content[i]);
  content[i] += taken;
  run.brought += moment_of(columns.solid, span[i], content[i]);
  ux = run.limited(ux);
  uy = run.limited(uy);
  run.came += static_cast<double>(taken) / UNITS_PER_CELL * Vec3{ux, uy, 0.0};
  const double head = head_of(columns.solid, span[i], content[i]).height;
  for (int d = 0; d < 2; ++d) {
    int links = 0;
    const auto height_at = [&](const LinkPlace &link, long other) { return link.d == d ? filled(link, head, other) : 0.0; };
    columns.each_link_of(i, [&](const LinkPlace &link, long other, bool) { links += height_at(link, other) > 0.0; });
    columns.each_link_of(i, [&](const LinkPlace &link, long other, bool) {
      const double height_there = height_at(link, other);
      if (height_there == 0.0) return;
      const double part = static_cast<double>(taken) / UNITS_PER_CELL / links;
      double &u = columns.arrays_of(link).u[link.at];
      const double was = u;
      u += std::min(1.0, part / height_there) * ((d == 0 ? ux : uy) - u);
      run.brought += 0.5 * height_there * (u * u - was * was);
    });
  }
  return taken;
}

Units WaveExchange::take(int column, double height, Units most)
{
  const int n = span_below(column, height);
  if (n < 0) return 0;
  const long i = columns.place(column, n);
  const Units film = static_cast<Units>(run.law.film * run.law.units_per_cell);
  const Units taken = std::clamp<Units>(content[i] - film, 0, most);
  if (taken == 0) return 0;
  run.resting = false;
  run.brought -= moment_of(columns.solid, span[i], content[i]);
  content[i] -= taken;
  run.brought += moment_of(columns.solid, span[i], content[i]);
  run.came -= static_cast<double>(taken) / UNITS_PER_CELL * velocity_of(i);
  return taken;
}

// Mean of the wet links of a span along each direction.
Vec3 WaveExchange::velocity_of(long i) const
{
  const double head = head_of(columns.solid, span[i], content[i]).height;
  double sum[2] = {0.0, 0.0}, count[2] = {0.0, 0.0};
  columns.each_link_of(i, [&](const LinkPlace &link, long other, bool) {
    if (filled(link, head, other) == 0.0) return;
    sum[link.d] += columns.arrays_of(link).u[link.at];
    count[link.d] += 1.0;
  });
  return {sum[0] / std::max(1.0, count[0]), sum[1] / std::max(1.0, count[1]), 0.0};
}

double WaveExchange::held_below(int column, double height) const
{
  const int n = span_below(column, height);
  return n < 0 ? 0.0 : static_cast<double>(content[columns.place(column, n)]) / UNITS_PER_CELL;
}

double WaveExchange::head_below(int column, double height) const
{
  const int n = span_below(column, height);
  return n < 0 ? 0.0 : head_of(columns.solid, span[columns.place(column, n)], content[columns.place(column, n)]).height;
}

WaveExchange::Top WaveExchange::top_of(int column) const
{
  if (columns.spans_in[column] == 0) return {};
  const long i = columns.place(column, columns.spans_in[column] - 1);
  const Head head = head_of(columns.solid, span[i], content[i]);
  Top top{span[i].floor, head.height, static_cast<double>(content[i]) / UNITS_PER_CELL, 0.0, {0.0, 0.0}, 0.0};
  if (!run.resting) top.rising = arrays.net[i] / (run.law.units_per_cell * run.law.dt * std::max(0.05, head.slope));
  double open[2] = {0.0, 0.0}, energy = 0.0;
  columns.each_link_of(i, [&](const LinkPlace &link, long other, bool) {
    const WaveLinks &l = columns.arrays_of(link);
    if (!columns.is_link(link) || l.height[link.at] == 0.0) return;
    open[link.d] += l.height[link.at];
    top.u[link.d] += l.height[link.at] * l.u[link.at];
    energy = std::max(energy, 0.5 * l.u[link.at] * l.u[link.at] + arrays.phi[other] - head.height);
  });
  for (int d = 0; d < 2; ++d)
    if (open[d] > 0.0) top.u[d] /= open[d];
  top.jet = std::sqrt(2.0 * energy);
  return top;
}

// --- what floats ---

WaveExchange::SpanView WaveExchange::span_view(int column, int n) const
{
  const long i = columns.place(column, n);
  const bool wet = static_cast<double>(content[i]) > run.law.film * run.law.units_per_cell;
  const bool full = arrays.full[i] > 0.0;
  const double seen = full ? arrays.phi[i] : head_of(columns.solid, span[i], content[i]).height;
  const double volume = static_cast<double>(content[i]) / UNITS_PER_CELL;
  return {span[i].low, span[i].high, span[i].floor, span[i].roof, arrays.phi[i], seen, volume, arrays.capacity[i], wet, full};
}

WaveExchange::Sides WaveExchange::around(int column, int n) const
{
  Sides sides{};
  double widest[4] = {0.0, 0.0, 0.0, 0.0};
  const long i = columns.place(column, n);
  columns.each_link_of(i, [&](const LinkPlace &link, long other, bool inward) {
    if (!columns.is_link(link)) return;
    const WaveLinks &l = columns.arrays_of(link);
    const double edge = l.edge[link.at], here = std::max(arrays.phi[i], edge), there = std::max(arrays.phi[other], edge);
    const int side = link.d == 0 ? (inward ? WEST : EAST) : (inward ? SOUTH : NORTH);
    const double open = std::min(std::max(here, there), l.top[link.at]) - edge;
    if (open <= widest[side]) return;
    widest[side] = open;
    sides.rise[side] = there - here;
    sides.u[side] = l.u[link.at];
  });
  return sides;
}

// Links of a column share its momentum in proportion to their open heights; a layer thin enough to count as none gets no more
// than a whole cell would.
void WaveExchange::add_impulse(const double *x, const double *y)
{
  const auto wetted = [&](const LinkPlace &link) {
    const Ends e = columns.ends(link);
    return columns.is_link(link) ? std::max(0.0, columns.opening(link, std::max(arrays.phi[e.a], arrays.phi[e.b]))) : 0.0;
  };
  for (int d = 0; d < 2; ++d)
    for (int column = 0; column < columns.nx * columns.ny; ++column) {
      const double impulse = (d == 0 ? x : y)[column];
      if (impulse == 0.0) continue;
      double open = 0.0;
      for (int n = 0; n < columns.spans_in[column]; ++n)
        columns.each_link_of(columns.place(column, n), [&](const LinkPlace &link, long, bool) {
          if (link.d == d) open += wetted(link);
        });
      const double faster = impulse / std::max(1.0, open);
      if (open == 0.0 || (run.resting && std::fabs(faster) < run.rest)) continue;
      run.resting = false;
      for (int n = 0; n < columns.spans_in[column]; ++n)
        columns.each_link_of(columns.place(column, n), [&](const LinkPlace &link, long, bool) {
          const double height = link.d == d ? wetted(link) : 0.0;
          if (height == 0.0) return;
          double &u = columns.arrays_of(link).u[link.at];
          const double wanted = u + faster;
          u = run.limited(wanted);
          if (u != wanted) (d == 0 ? run.lost.x : run.lost.y) += (wanted - u) * height;
        });
    }
}

}    // namespace mdanim
