// SPDX-License-Identifier: GPL-2.0-only
// Faces of walls, and the pressure of the columns beside them.

#include "liquid/waves/wave_walls.h"

#include "liquid/waves/columns.h"

#include <algorithm>

namespace mdanim {

// Layers of a face with the same solid part are joined. Between cells that are both shut there is no liquid.
void WaveWalls::list_faces()
{
  faces.clear();
  for (int column = 0; column < columns.nx * columns.ny; ++column)
    for (int side = 0; side < 4; ++side) {
      const int other = neighbour(column, side, columns.nx, columns.ny);
      if (other >= 0 && other < column) continue;    // the other column reports this face
      const double x = side == 0 ? -1.0 : side == 1 ? 1.0 : 0.0, y = side == 2 ? -1.0 : side == 3 ? 1.0 : 0.0;
      const auto closed = [&](int z) {
        if (other < 0) return 1.0;
        if (columns.wall.at(column, z) + columns.wall.at(other, z) == 0 ||
            (columns.wall.shut(column, z) && columns.wall.shut(other, z)))
          return 0.0;
        return 1.0 - columns.wall.open_between(column, other, z) / static_cast<double>(SolidParts::FULL);
      };
      for (int low = 0, high = 0; low < columns.nz; low = high) {
        const double part = closed(low);
        for (high = low + 1; high < columns.nz && closed(high) == part; ++high) {}
        if (part > 0.0) faces.push_back({column, other, low, high, part * x, part * y});
      }
    }
}

// Pressure of the liquid in a column, on a side from one layer to another.
double WaveWalls::pressure_on(int column, int low, int high) const
{
  double sum = 0.0;
  for (int n = 0; n < columns.spans_in[column]; ++n) {
    const long i = columns.place(column, n);
    const int from = std::max(low, columns.span[i].low), to = std::min(high, columns.span[i].high);
    if (columns.content[i] == 0 || from >= to) continue;
    const double below = std::max(0.0, columns.arrays.phi[i] - from), above = std::max(0.0, columns.arrays.phi[i] - to);
    sum += 0.5 * (below * below - above * above);
  }
  return sum;
}

Vec3 WaveWalls::force() const
{
  Vec3 sum;
  for (const WallFace &face : faces) {
    const double behind = face.other < 0 ? 0.0 : pressure_on(face.other, face.low, face.high);
    const double push = pressure_on(face.column, face.low, face.high) - behind;
    sum.x += face.x * push;
    sum.y += face.y * push;
  }
  return sum;
}

}    // namespace mdanim
