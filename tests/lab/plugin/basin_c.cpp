// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions over an AutomatonBasin of unit cells at the origin, for tests: solids are particles that fill their cells in
// part.

#include "c_api/abi.h"
#include "c_api/guarded.h"
#include "liquid/automaton/automaton_basin.h"

#include <cmath>
#include <vector>

using mdanim::AutomatonBasin;
using mdanim::Basin;

namespace {

// Ranks that all have the same values.
class EqualRanks : public mdanim::RankSums {
 public:
  explicit EqualRanks(int count) : count(count) {}
  bool alone() const override { return count == 1; }
  void add(int *values, int n) const override
  {
    for (int k = 0; k < n; ++k) values[k] *= count;
  }

 private:
  int count;
};

struct TestBasin {
  EqualRanks ranks;
  AutomatonBasin basin;
  std::int64_t step = 0;    // of the last look

  TestBasin(int nx, int ny, int nz, int ranks_count)
      : ranks(ranks_count),
        basin({nx, ny, nz, {}, {1.0, 1.0, 1.0}}, 1.0, 1, mdanim::Vertical::LOWER, AutomatonBasin::Immersion::SURFACE, ranks)
  {
  }
};

// A lattice cell about a place, whose volume is `share` of a cell, for each row of (x, y, z, share).
Basin::AddBodies bodies(const double *solids, int count)
{
  return [=](mdanim::Occupancy &into, double below) {
    for (const double *s = solids; s < solids + 4 * count; s += 4) {
      mdanim::Vec3 corner[8];
      const double half = 0.5 * std::cbrt(s[3]);
      for (int k = 0; k < 8; ++k)    // VTK order
        corner[k] = {s[0] + ((k + 1) / 2 % 2 ? half : -half), s[1] + (k / 2 % 2 ? half : -half), s[2] + (k / 4 ? half : -half)};
      if (corner[0].z <= below) into.add(corner, false, -1, {0, into.ny}, into.touched);
    }
  };
}

TestBasin &of(void *b) { return *static_cast<TestBasin *>(b); }

}    // namespace

MDANIM_EXPORT void *mdanim_basin_new(int nx, int ny, int nz, int ranks) { return new TestBasin(nx, ny, nz, ranks); }

MDANIM_EXPORT void mdanim_basin_free(void *b) { delete &of(b); }

// Solids (count, 4), and units of liquid into what they leave. Returns how many find no room.
MDANIM_EXPORT long mdanim_basin_pour(void *b, const double *solids, int count, long units)
{
  AutomatonBasin &basin = of(b).basin;
  basin.mark_moving(bodies(solids, count));
  return basin.pour(units, std::vector<std::uint8_t>(basin.cells().nx * basin.cells().ny * basin.cells().nz, 1), 0);
}

// One look, which is that of the next steps.
MDANIM_EXPORT int mdanim_basin_is_due(void *b, double fastest, double dt)
{ return of(b).basin.is_due(fastest, dt, of(b).step += of(b).basin.pace.every); }

// Returns 0, or 1 with a message.
MDANIM_EXPORT int mdanim_basin_update(void *b, const double *solids, int count, std::uint64_t when, char *error, int error_size)
{
  return mdanim::guarded(error, error_size, [&] { of(b).basin.update(bodies(solids, count), when); });
}

MDANIM_EXPORT void mdanim_basin_contents(void *b, std::uint8_t *out) { of(b).basin.contents(out); }

MDANIM_EXPORT int mdanim_basin_is_calm(void *b) { return of(b).basin.is_calm(); }

// Takes up the state of another; returns 0, or 1 with a message.
MDANIM_EXPORT int mdanim_basin_copy(void *from, void *to, char *error, int error_size)
{
  return mdanim::guarded(error, error_size, [&] {
    const std::vector<std::uint8_t> state = of(from).basin.state({});
    of(to).basin.set_state(state.data(), state.size());
  });
}
