// SPDX-License-Identifier: GPL-2.0-only
// Pressure on the sides of the basin and of held bodies in it: phi - z, as in Waves::add_forces(). It is an output and changes
// nothing.

#include "liquid/waves/columns.h"
#include "liquid/waves/waves.h"

#include <algorithm>

namespace mdanim {

void Waves::set_walls(const std::uint16_t *held)
{
  for (int column = 0; column < nx * ny; ++column) {
    std::uint16_t *const own = &wall.part[static_cast<std::size_t>(column) * nz];
    const std::uint16_t *const now = held + static_cast<std::size_t>(column) * nz;
    if (std::equal(now, now + nz, own)) continue;
    std::copy_n(now, nz, own);
    cut_anew(column, walled_anew);
  }
  list_wall_faces();
}

// Layers of a face with the same solid part are joined. Between cells that are both shut there is no liquid.
void Waves::list_wall_faces()
{
  wall_faces.clear();
  for (int column = 0; column < nx * ny; ++column)
    for (int side = 0; side < 4; ++side) {
      const int other = neighbour(column, side, nx, ny);
      if (other >= 0 && other < column) continue;    // the other column reports this face
      const double x = side == 0 ? -1.0 : side == 1 ? 1.0 : 0.0, y = side == 2 ? -1.0 : side == 3 ? 1.0 : 0.0;
      const auto closed = [&](int z) {
        if (other < 0) return 1.0;
        if (wall.at(column, z) + wall.at(other, z) == 0 || (wall.shut(column, z) && wall.shut(other, z))) return 0.0;
        return 1.0 - wall.open_between(column, other, z) / static_cast<double>(SolidParts::FULL);
      };
      for (int low = 0, high = 0; low < nz; low = high) {
        const double part = closed(low);
        for (high = low + 1; high < nz && closed(high) == part; ++high) {}
        if (part > 0.0) wall_faces.push_back({column, other, low, high, part * x, part * y});
      }
    }
}

// Pressure of the liquid in a column, on a side from one layer to another.
double Waves::pressure_on(int column, int low, int high) const
{
  double sum = 0.0;
  for (int n = 0; n < spans_in[column]; ++n) {
    const long i = place(column, n);
    const int from = std::max(low, span[i].low), to = std::min(high, span[i].high);
    if (content[i] == 0 || from >= to) continue;
    const double below = std::max(0.0, arrays.phi[i] - from), above = std::max(0.0, arrays.phi[i] - to);
    sum += 0.5 * (below * below - above * above);
  }
  return sum;
}

Vec3 Waves::force_on_walls() const
{
  Vec3 sum;
  for (const WallFace &face : wall_faces) {
    const double behind = face.other < 0 ? 0.0 : pressure_on(face.other, face.low, face.high);
    const double push = pressure_on(face.column, face.low, face.high) - behind;
    sum.x += face.x * push;
    sum.y += face.y * push;
  }
  return sum;
}

}    // namespace mdanim
