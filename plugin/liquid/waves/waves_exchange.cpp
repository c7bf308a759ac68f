// SPDX-License-Identifier: GPL-2.0-only
// Liquid that comes into columns and leaves them between updates: drops, inflows and drains. Links do not count it, so the caller
// keeps the account.

#include "liquid/waves/waves.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

// The span that holds a height, or else the next one below it; the lowest where there is none. Negative without spans.
int Waves::span_below(int column, double height) const
{
  int n = spans_in[column] - 1;
  while (n > 0 && span[place(column, n)].floor > height) --n;
  return n;
}

// Height to which a link of a span with this head is filled by the present contents of the spans: wetted heights belong to the
// last update, and are not a part of the state.
double Waves::filled(const LinkPlace &link, double head, long other) const
{
  if (!is_link(link)) return 0.0;
  return std::max(0.0, opening(link, std::max(head, head_of(solid, span[other], content[other]).height)));
}

Units Waves::give(int column, double height, Units units, double ux, double uy)
{
  const int n = span_below(column, height);
  if (n < 0) return 0;
  const long i = place(column, n);
  const Units taken = std::clamp<Units>(span[i].capacity - content[i], 0, units);
  if (taken == 0) return 0;
  resting = false;
  content[i] += taken;
  ux = limited(ux);
  uy = limited(uy);
  came += static_cast<double>(taken) / UNITS_PER_CELL * Vec3{ux, uy, 0.0};
  const double head = head_of(solid, span[i], content[i]).height;
  for (int d = 0; d < 2; ++d) {
    int links = 0;
    const auto height_at = [&](const LinkPlace &link, long other) { return link.d == d ? filled(link, head, other) : 0.0; };
    each_link_of(i, [&](const LinkPlace &link, long other, bool) { links += height_at(link, other) > 0.0; });
    each_link_of(i, [&](const LinkPlace &link, long other, bool) {
      const double height_there = height_at(link, other);
      if (height_there == 0.0) return;
      const double part = static_cast<double>(taken) / UNITS_PER_CELL / links;
      double &u = arrays_of(link).u[link.at];
      u += std::min(1.0, part / height_there) * ((d == 0 ? ux : uy) - u);
    });
  }
  return taken;
}

Units Waves::take(int column, double height, Units most)
{
  const int n = span_below(column, height);
  if (n < 0) return 0;
  const long i = place(column, n);
  const Units film = static_cast<Units>(law.film * law.units_per_cell);
  const Units taken = std::clamp<Units>(content[i] - film, 0, most);
  if (taken == 0) return 0;
  resting = false;
  content[i] -= taken;
  came -= static_cast<double>(taken) / UNITS_PER_CELL * velocity_of(i);
  return taken;
}

// Mean of the wet links of a span along each direction.
Vec3 Waves::velocity_of(long i) const
{
  const double head = head_of(solid, span[i], content[i]).height;
  double sum[2] = {0.0, 0.0}, count[2] = {0.0, 0.0};
  each_link_of(i, [&](const LinkPlace &link, long other, bool) {
    if (filled(link, head, other) == 0.0) return;
    sum[link.d] += arrays_of(link).u[link.at];
    count[link.d] += 1.0;
  });
  return {sum[0] / std::max(1.0, count[0]), sum[1] / std::max(1.0, count[1]), 0.0};
}

double Waves::held_below(int column, double height) const
{
  const int n = span_below(column, height);
  return n < 0 ? 0.0 : static_cast<double>(content[place(column, n)]) / UNITS_PER_CELL;
}

double Waves::head_below(int column, double height) const
{
  const int n = span_below(column, height);
  return n < 0 ? 0.0 : head_of(solid, span[place(column, n)], content[place(column, n)]).height;
}

Waves::Top Waves::top_of(int column) const
{
  if (spans_in[column] == 0) return {};
  const long i = place(column, spans_in[column] - 1);
  const Head head = head_of(solid, span[i], content[i]);
  Top top{span[i].floor, head.height, static_cast<double>(content[i]) / UNITS_PER_CELL, 0.0, {0.0, 0.0}, 0.0};
  if (!resting) top.rising = arrays.net[i] / (law.units_per_cell * law.dt * std::max(0.05, head.slope));
  double open[2] = {0.0, 0.0}, energy = 0.0;
  each_link_of(i, [&](const LinkPlace &link, long other, bool) {
    const WaveLinks &l = arrays_of(link);
    if (!is_link(link) || l.height[link.at] == 0.0) return;
    open[link.d] += l.height[link.at];
    top.u[link.d] += l.height[link.at] * l.u[link.at];
    energy = std::max(energy, 0.5 * l.u[link.at] * l.u[link.at] + arrays.phi[other] - head.height);
  });
  for (int d = 0; d < 2; ++d)
    if (open[d] > 0.0) top.u[d] /= open[d];
  top.jet = std::sqrt(2.0 * energy);
  return top;
}

}    // namespace mdanim
