// SPDX-License-Identifier: GPL-2.0-only
// Bodies that turn in an automaton by one thread and by several: which cells they fill, what they displace, and sweeps; for the
// thread sanitizer (tests/sanitize.py). Exit code 1 when a cell differs.

#include "liquid/automaton/automaton.h"
#include "liquid/occupancy.h"
#include "threads/row_slabs.h"

#include <cmath>
#include <cstdio>

using namespace mdanim;

namespace {

constexpr int NX = 29, NY = 34, NZ = 24, EDGE = 8, STEPS = 12;

// Corners of the n-th lattice cell of a cube that is turned about the vertical; the last cell is stretched over many rows.
void corners_of(long n, double angle, Vec3 corner[8])
{
  const double c = std::cos(angle), s = std::sin(angle);
  const long i = n % EDGE, j = n / EDGE % EDGE, k = n / EDGE / EDGE;
  for (int v = 0; v < 8; ++v) {
    double x = i - 0.5 * EDGE + ((v + 1) / 2 % 2), y = j - 0.5 * EDGE + v / 2 % 2;
    if (n == EDGE * EDGE * EDGE - 1 && v / 2 % 2) y += 14.0;
    corner[v] = {14.3 + c * x - s * y, 15.1 + s * x + c * y, 4.2 + k + v / 4};
  }
}

std::vector<std::uint8_t> film(int threads)
{
  const Threads some(threads);
  Automaton automaton(NX, NY, NZ, 7);
  automaton.use(some);
  automaton.fill(9L * NX * NY, nullptr, 0);
  Occupancy occupancy(NX, NY, NZ);
  RowSlabs slabs;
  std::vector<std::uint8_t> solid(occupancy.count.size());
  for (int n = 0; n < STEPS; ++n) {
    std::vector<CellBox> reached(RowSlabs::slabs_of(NY));
    const auto row_of = [&](long cell) {
      Vec3 corner[8];
      corners_of(cell, 0.1 * n, corner);
      return static_cast<int>(0.5 * (corner[0].y + corner[6].y));
    };
    const auto add = [&](Occupancy &all) {
      slabs.each(some, NY, EDGE * EDGE * EDGE, 100.0, row_of, [&](long cell, const RowSlabs::Rows &rows, int slab) {
        Vec3 corner[8];
        corners_of(cell, 0.1 * n, corner);
        return all.add(corner, false, -1, rows, reached[slab]);
      });
      for (const CellBox &of_slab : reached) all.touched.take_in(of_slab);
    };
    occupancy.count_anew(add, RankSums(), some);
    for (std::size_t c = 0; c < solid.size(); ++c) solid[c] = 2 * occupancy.count[c] >= Occupancy::FULL;
    const long changed = automaton.displace(solid.data(), n);
    for (int k = 0; k < 4; ++k) automaton.sweep(4 * n + k);
    if (n + 1 == STEPS) std::printf("%d threads, %ld cells changed, %ld solid\n", threads, changed, automaton.count_solid());
  }
  return automaton.cells.content;
}

}    // namespace

int main()
{
  const std::vector<std::uint8_t> alone = film(1);
  for (const int threads : {2, 4, 5})
    if (film(threads) != alone) {
      std::printf("%d threads give other cells\n", threads);
      return 1;
    }
  return 0;
}
