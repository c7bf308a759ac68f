// SPDX-License-Identifier: GPL-2.0-only
// Data of the liquid for floating bodies, and the impulses from them.

#include "liquid/waves/waves.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

Waves::SpanView Waves::span_view(int column, int n) const
{
  const long i = place(column, n);
  const bool wet = static_cast<double>(content[i]) > law.film * law.units_per_cell;
  const bool full = arrays.full[i] > 0.0;
  const double seen = full ? arrays.phi[i] : head_of(solid, span[i], content[i]).height;
  const double volume = static_cast<double>(content[i]) / UNITS_PER_CELL;
  return {span[i].low, span[i].high, span[i].floor, span[i].roof, arrays.phi[i], seen, volume, arrays.capacity[i], wet, full};
}

Waves::Sides Waves::around(int column, int n) const
{
  Sides sides{};
  double widest[4] = {0.0, 0.0, 0.0, 0.0};
  const long i = place(column, n);
  each_link_of(i, [&](const LinkPlace &link, long other, bool inward) {
    if (!is_link(link)) return;
    const WaveLinks &l = arrays_of(link);
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
void Waves::add_impulse(const double *x, const double *y)
{
  const auto wetted = [&](const LinkPlace &link) {
    const Ends e = ends(link);
    return is_link(link) ? std::max(0.0, opening(link, std::max(arrays.phi[e.a], arrays.phi[e.b]))) : 0.0;
  };
  for (int d = 0; d < 2; ++d)
    for (int column = 0; column < nx * ny; ++column) {
      const double impulse = (d == 0 ? x : y)[column];
      if (impulse == 0.0) continue;
      double open = 0.0;
      for (int n = 0; n < spans_in[column]; ++n)
        each_link_of(place(column, n), [&](const LinkPlace &link, long, bool) {
          if (link.d == d) open += wetted(link);
        });
      const double faster = impulse / std::max(1.0, open);
      if (open == 0.0 || (resting && std::fabs(faster) < rest)) continue;
      resting = false;
      for (int n = 0; n < spans_in[column]; ++n)
        each_link_of(place(column, n), [&](const LinkPlace &link, long, bool) {
          const double height = link.d == d ? wetted(link) : 0.0;
          if (height == 0.0) return;
          double &u = arrays_of(link).u[link.at];
          const double wanted = u + faster;
          u = limited(wanted);
          if (u != wanted) (d == 0 ? lost.x : lost.y) += (wanted - u) * height;
        });
    }
}

}    // namespace mdanim
