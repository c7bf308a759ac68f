// SPDX-License-Identifier: GPL-2.0-only
// Who is near whom, four others at a time (pair_filter.h); compiled once for each kind of processor (pair_filter_*.cpp).

#define LANES 4

#include "engine/pair_filter.h"
#include "engine/vectors.h"

namespace mdanim {
namespace {

static_assert(STRIP == LANES, "a strip is a vector");

typedef long long Answers __attribute__((vector_size(8 * LANES)));    // -1 for yes, 0 for no

// Bit n tells what lane n says.
MDANIM_INLINE int bits(Answers yes)
{
#ifdef __AVX2__
  return __builtin_ia32_movmskpd256(reinterpret_cast<Vector>(yes));
#else
  return static_cast<int>((yes[0] & 1) | (yes[1] & 2) | (yes[2] & 4) | (yes[3] & 8));
#endif
}

// The numbers from `first` on whose bits are set, put behind `many` others; without a branch that nobody could foretell.
MDANIM_INLINE int append(int bits, int first, int *found, int many)
{
  for (int lane = 0; lane < LANES; ++lane) {
    found[many] = first + lane;
    many += bits >> lane & 1;
  }
  return many;
}

MDANIM_INLINE Vector all_lanes(double a) { return Vector{a, a, a, a}; }

// r^2 between one place and those from k on.
MDANIM_INLINE Vector square(Vector x, Vector y, Vector z, const double *const *place, int k)
{
  const Vector dx = x - load(place[0] + k), dy = y - load(place[1] + k), dz = z - load(place[2] + k);
  return (dx * dx + dy * dy) + dz * dz;
}

// Most strips have no pair in reach, and none is looked at twice: again without a branch.
int in_reach(const Candidates &all, int *found)
{
  const double *const place[] = {all.place[0], all.place[1], all.place[2]};
  StripMask *const lanes = all.lanes;
  const int strips = all.strips;
  int some = 0;
  for (int n = 0; n < strips; ++n) {
    const auto [one, first] = all.strip[n];
    const Vector x = all_lanes(place[0][one]), y = all_lanes(place[1][one]), z = all_lanes(place[2][one]);
    const int near = bits(square(x, y, z, place, first) < load(all.reach2 + LANES * n));
    lanes[some] = {n, near};
    some += near != 0;
  }
  int many = 0;
  for (int n = 0; n < some; ++n) many = append(lanes[n].bits, LANES * lanes[n].strip, found, many);
  return many;
}

int within(const double *const *place, int from, int to, const double *at, double range2, int *found)
{
  const Vector x = all_lanes(at[0]), y = all_lanes(at[1]), z = all_lanes(at[2]);
  int many = 0;
  for (int k = from; k < to; k += LANES) {
    const int wanted = to - k < LANES ? (1 << (to - k)) - 1 : -1;
    many = append(bits(square(x, y, z, place, k) < range2) & wanted, k, found, many);
  }
  return many;
}

}    // namespace
}    // namespace mdanim
