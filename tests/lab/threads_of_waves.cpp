// SPDX-License-Identifier: GPL-2.0-only
// A splash of waves beside a shelf by one thread and by several, for the thread sanitizer (tests/sanitize.py). Exit code 1 when a
// bit differs.

#include "liquid/waves/waves.h"

#include <cmath>
#include <cstdio>

using namespace mdanim;

namespace {

constexpr int NX = 29, NY = 23, NZ = 20, UPDATES = 25;

std::vector<std::uint8_t> splash(int threads)
{
  Waves waves(NX, NY, NZ);
  waves.use(Threads(threads));
  std::vector<std::uint16_t> part(NX * NY * NZ);
  std::vector<double> mass(NX * NY), height(NX * NY);
  const auto at = [](int x, int y, int z) { return (y * NX + x) * NZ + z; };
  for (int z = 6; z < 8; ++z)
    for (int y = 2; y < 9; ++y)
      for (int x = 0; x < 14; ++x) part[at(x, y, z)] = SolidParts::FULL;
  waves.set_solids(part.data(), mass.data());
  for (int y = 0; y < NY; ++y)
    for (int x = 0; x < NX; ++x) height[y * NX + x] = 10.0 + 2.0 * std::sin(0.4 * x) * std::cos(0.3 * y);
  waves.pour(height.data());
  for (int n = 0; n < UPDATES; ++n) {
    const int bottom = 14 - n / 3;    // of a block that comes down, which floats
    for (int z = 0; z < NZ; ++z)
      for (int y = 12; y < 18; ++y)
        for (int x = 9; x < 16; ++x) {
          const int there = x == 9 || x == 15 ? SolidParts::FULL / 2 : SolidParts::FULL;    // with porous columns at its sides
          part[at(x, y, z)] = z >= bottom && z < bottom + 5 ? there : 0;
          mass[y * NX + x] = 3.0;
        }
    waves.set_solids(part.data(), mass.data());
    waves.update(0.15);
  }
  std::printf("%d threads, %ld iterations, %ld times limited\n", threads, waves.run.counts.iterations, waves.run.counts.limited);
  return waves.state();
}

}    // namespace

int main()
{
  const std::vector<std::uint8_t> alone = splash(1);
  for (const int threads : {2, 4, 5})
    if (splash(threads) != alone) {
      std::printf("%d threads give other bits\n", threads);
      return 1;
    }
  return 0;
}
