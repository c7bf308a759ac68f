// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions over Leveller and smooth_surface, for tests and benchmarks. Grids are (nz, ny, nx), x fastest.

#include "c_api/abi.h"
#include "liquid/automaton/cells.h"
#include "liquid/automaton/level.h"
#include "liquid/automaton/surface.h"

using mdanim::Cells;

namespace {

struct LevelledCells {
  Cells cells;
  mdanim::Leveller leveller;
};

LevelledCells &pool(void *p) { return *static_cast<LevelledCells *>(p); }

}    // namespace

MDANIM_EXPORT void *mdanim_level_new(int nx, int ny, int nz) { return new LevelledCells{Cells(nx, ny, nz), {}}; }

MDANIM_EXPORT void mdanim_level_delete(void *p) { delete &pool(p); }

// `solid`: 0 open, 1 solid, 2 solid and still.
MDANIM_EXPORT void mdanim_level_set(void *p, const std::uint8_t *content, const std::uint8_t *solid)
{
  Cells &cells = pool(p).cells;
  cells.each([&](int x, int y, int z) {
    const std::size_t place = cells.at(x, y, z);
    cells.content[place] = *content++;
    cells.open[place] = *solid == 0 ? Cells::OPEN : Cells::SOLID;
    cells.still[place] = *solid++ == 2;
  });
}

MDANIM_EXPORT void mdanim_level_get(void *p, std::uint8_t *content)
{
  const Cells &cells = pool(p).cells;
  cells.each([&](int x, int y, int z) { *content++ = cells.content[cells.at(x, y, z)]; });
}

MDANIM_EXPORT long mdanim_level_move(void *p, std::uint64_t seed, std::uint64_t when, double rate, long at_least)
{ return pool(p).leveller.move(pool(p).cells, seed, when, rate, at_least); }

MDANIM_EXPORT int mdanim_level_heights(void *p, double *height, int just_moved)
{ return pool(p).leveller.heights(pool(p).cells, height, just_moved != 0); }

MDANIM_EXPORT void mdanim_smooth_surface(int nx, int ny, const double *height, const std::uint8_t *blocked, double *smooth)
{ mdanim::smooth_surface(nx, ny, height, blocked, smooth); }
