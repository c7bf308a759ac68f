// SPDX-License-Identifier: GPL-2.0-only

#include "waves_probe.h"

#include <algorithm>

namespace mdanim {

std::vector<WavesProbe::SpanNow> WavesProbe::spans() const
{
  std::vector<SpanNow> now;
  columns.each_span([&](long i) {
    const bool full = arrays.full[i] > 0.0;
    const double head = full ? arrays.rest[i] : head_of(columns.solid, columns.span[i], columns.content[i]).height;
    now.push_back({columns.span[i], columns.content[i], head, arrays.phi[i], full});
  });
  return now;
}

std::vector<WavesProbe::LinkNow> WavesProbe::links() const
{
  std::vector<int> number(columns.content.size(), -1);
  int next = 0;
  columns.each_span([&](long i) { number[i] = next++; });
  std::vector<LinkNow> now;
  columns.each_link([&](const LinkPlace &link) {
    const WaveLinks &l = columns.arrays_of(link);
    const Ends e = columns.ends(link);
    now.push_back({number[e.a], number[e.b], link.d, l.u[link.at], l.height[link.at], static_cast<Units>(l.units[link.at])});
  });
  return now;
}

void WavesProbe::surface(double *head, double *volume) const
{
  for (int column = 0; column < columns.nx * columns.ny; ++column) {
    head[column] = volume[column] = 0.0;
    for (int n = 0; n < columns.spans_in[column]; ++n) {
      const long i = columns.place(column, n);
      volume[column] += static_cast<double>(columns.content[i]) / UNITS_PER_CELL;
      if (n > 0 && columns.content[i] == 0) continue;
      head[column] = arrays.full[i] > 0.0 ? arrays.phi[i] : head_of(columns.solid, columns.span[i], columns.content[i]).height;
    }
  }
}

void WavesProbe::set_velocities(const double *u)
{
  waves.run.resting = false;
  columns.each_link([&](const LinkPlace &link) {
    const Ends e = columns.ends(link);
    const long upwind = *u > 0.0 ? e.a : e.b;
    const double level = std::max(head_of(columns.solid, columns.span[upwind], columns.content[upwind]).height,
                                  columns.arrays_of(link).edge[link.at]);
    columns.arrays_of(link).u[link.at] = *u;
    columns.arrays_of(link).q[link.at] = *u * columns.opening(link, level);
    ++u;
  });
}

void WavesProbe::use_general_form()
{
  columns.all_general = true;
  columns.list_irregular();
}

// Pressure phi - z on every face between solid and wet cells. At rest it is Archimedes' lift, and sideways forces add up to
// nothing. Under a moving body phi holds the force that moves the liquid around it.
void WavesProbe::add_forces(const std::int32_t *owner, double *force) const
{
  const long layer = static_cast<long>(columns.nx) * columns.ny;
  const auto add = [&](int column, int z, int d, double push) {
    if (z < 0 || z >= columns.nz) return;
    const std::int32_t body = owner[z * layer + column];
    if (body >= 0) force[3 * body + d] += push;
  };

  // Up and down: on the roof, on the floor, and on what is solid of cells between them.
  std::vector<double> pressure(static_cast<std::size_t>(layer) * columns.nz, 0.0);    // on a whole side of each cell
  columns.each_span([&](long i) {
    const Span &s = columns.span[i];
    if (columns.content[i] == 0) return;
    const double phi = arrays.phi[i];
    if (arrays.full[i] > 0.0) add(s.column, s.high, 2, std::max(0.0, phi - s.roof));
    add(s.column, s.low - 1, 2, -std::max(0.0, phi - s.floor));
    for (int z = s.low; z < s.high; ++z) {
      const bool end = s.plain || (z == s.low && s.floor > z) || (z == s.high - 1 && s.roof < z + 1.0);
      if (!end && columns.solid.at(s.column, z) > 0)
        add(s.column, z, 2,
            columns.solid.at(s.column, z) / static_cast<double>(SolidParts::FULL) * std::clamp(phi - z, 0.0, 1.0));
      const double wet = std::clamp(phi - z, 0.0, 1.0);
      pressure[z * layer + s.column] = wet * (phi - z) - 0.5 * wet * wet;
    }
  });

  for (int z = 0; z < columns.nz; ++z)
    for (int column = 0; column < layer; ++column)
      for (int d = 0; d < 2; ++d) {
        if (d == 0 ? column % columns.nx == columns.nx - 1 : column / columns.nx == columns.ny - 1) continue;
        const int other = column + (d == 0 ? 1 : columns.nx), part = columns.solid.at(column, z),
                  other_part = columns.solid.at(other, z);
        if (part + other_part == 0) continue;
        const double closed = 1.0 - columns.solid.open_between(column, other, z) / static_cast<double>(SolidParts::FULL);
        const auto on = [&](int c) { return columns.solid.shut(c, z) ? 0.0 : pressure[z * layer + c]; };
        add(part > other_part ? column : other, z, d, closed * (on(column) - on(other)));
      }
}

}    // namespace mdanim
