// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions over Leveller and smooth_surface, for tests and benchmarks. Grids are (nz, ny, nx), x
// fastest.

#include "c_api/abi.h"
#include "liquid/cells.h"
#include "liquid/level.h"
#include "liquid/surface.h"

using mdanim::Cells;

namespace {

struct Pool {
  Cells cells;
  mdanim::Leveller leveller;

  template <class Visit> void each_cell(Visit visit)
  {
    std::size_t n = 0;
    for (int z = 0; z < cells.nz; ++z)
      for (int y = 0; y < cells.ny; ++y)
        for (int x = 0; x < cells.nx; ++x) visit(cells.at(x, y, z), n++);
  }
};

}    // namespace

MDANIM_EXPORT void *mdanim_level_new(int nx, int ny, int nz) { return new Pool{Cells(nx, ny, nz), {}}; }

MDANIM_EXPORT void mdanim_level_delete(void *pool) { delete static_cast<Pool *>(pool); }

// `solid`: 0 open, 1 solid, 2 solid and still.
MDANIM_EXPORT void mdanim_level_set(void *pool, const std::uint8_t *content, const std::uint8_t *solid)
{
  auto *p = static_cast<Pool *>(pool);
  p->each_cell([&](std::size_t place, std::size_t n) {
    p->cells.content[place] = content[n];
    p->cells.open[place] = solid[n] == 0 ? Cells::OPEN : Cells::SOLID;
    p->cells.still[place] = solid[n] == 2;
  });
}

MDANIM_EXPORT void mdanim_level_get(void *pool, std::uint8_t *content)
{
  auto *p = static_cast<Pool *>(pool);
  p->each_cell([&](std::size_t place, std::size_t n) { content[n] = p->cells.content[place]; });
}

MDANIM_EXPORT long mdanim_level_move(void *pool, std::uint64_t seed, std::uint64_t when, double rate, long at_least)
{
  auto *p = static_cast<Pool *>(pool);
  return p->leveller.move(p->cells, seed, when, rate, at_least);
}

MDANIM_EXPORT int mdanim_level_heights(void *pool, double *height, int just_moved)
{
  auto *p = static_cast<Pool *>(pool);
  return p->leveller.heights(p->cells, height, just_moved != 0);
}

MDANIM_EXPORT void mdanim_smooth_surface(int nx, int ny, const double *height, const std::uint8_t *blocked, double *smooth)
{ mdanim::smooth_surface(nx, ny, height, blocked, smooth); }
