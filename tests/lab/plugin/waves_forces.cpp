// SPDX-License-Identifier: GPL-2.0-only
// Forces on solids: pressure phi - z on every face between solid and wet cells. At rest it is Archimedes' lift, and what pushes
// sideways adds up to nothing. Under a moving body phi holds what the liquid around it takes to be moved.

#include "liquid/waves/waves.h"

#include <algorithm>

namespace mdanim {

void Waves::add_forces(const std::int32_t *owner, double *force) const
{
  const long layer = static_cast<long>(nx) * ny;
  const auto add = [&](int column, int z, int d, double push) {
    if (z < 0 || z >= nz) return;
    const std::int32_t body = owner[z * layer + column];
    if (body >= 0) force[3 * body + d] += push;
  };

  // Up and down: on the roof, on the floor, and on what is solid of cells between them.
  std::vector<double> pressure(static_cast<std::size_t>(layer) * nz, 0.0);    // on a whole side of each cell
  each_span([&](long i) {
    const Span &s = span[i];
    if (content[i] == 0) return;
    const double phi = arrays.phi[i];
    if (arrays.full[i] > 0.0) add(s.column, s.high, 2, std::max(0.0, phi - s.roof));
    add(s.column, s.low - 1, 2, -std::max(0.0, phi - s.floor));
    for (int z = s.low; z < s.high; ++z) {
      const bool end = s.plain || (z == s.low && s.floor > z) || (z == s.high - 1 && s.roof < z + 1.0);
      if (!end && solid.at(s.column, z) > 0)
        add(s.column, z, 2, solid.at(s.column, z) / static_cast<double>(SolidParts::FULL) * std::clamp(phi - z, 0.0, 1.0));
      const double wet = std::clamp(phi - z, 0.0, 1.0);
      pressure[z * layer + s.column] = wet * (phi - z) - 0.5 * wet * wet;
    }
  });

  for (int z = 0; z < nz; ++z)
    for (int column = 0; column < layer; ++column)
      for (int d = 0; d < 2; ++d) {
        if (d == 0 ? column % nx == nx - 1 : column / nx == ny - 1) continue;
        const int other = column + (d == 0 ? 1 : nx), part = solid.at(column, z), other_part = solid.at(other, z);
        if (part + other_part == 0) continue;
        const double closed = 1.0 - solid.open_between(column, other, z) / static_cast<double>(SolidParts::FULL);
        const auto on = [&](int c) { return solid.shut(c, z) ? 0.0 : pressure[z * layer + c]; };
        add(part > other_part ? column : other, z, d, closed * (on(column) - on(other)));
      }
}

}    // namespace mdanim
