// SPDX-License-Identifier: GPL-2.0-only
// Which particles are near each other, four others at a time (pair_filter.h).

#ifndef MDANIM_PAIR_FILTER_KERNEL_H
#define MDANIM_PAIR_FILTER_KERNEL_H

#include "engine/pair_filter.h"
#include "engine/vectors.h"

namespace mdanim {
namespace {

typedef double Four __attribute__((vector_size(8 * STRIP)));
typedef long long Answers __attribute__((vector_size(8 * STRIP)));    // -1 for yes, 0 for no

// Bit n tells what lane n says.
MDANIM_ALWAYS_INLINE int bits(Answers yes)
{
#ifdef __AVX2__
  return __builtin_ia32_movmskpd256(reinterpret_cast<Four>(yes));
#else
  return static_cast<int>((yes[0] & 1) | (yes[1] & 2) | (yes[2] & 4) | (yes[3] & 8));
#endif
}

// The numbers from `first` on whose bits are set, put behind `many` others; without a branch that cannot be predicted.
MDANIM_ALWAYS_INLINE int append(int bits, int first, int *found, int many)
{
  for (int lane = 0; lane < STRIP; ++lane) {
    found[many] = first + lane;
    many += bits >> lane & 1;
  }
  return many;
}

MDANIM_ALWAYS_INLINE Four all_lanes(double a) { return Four{a, a, a, a}; }

// r^2 between one place and those from k on.
MDANIM_ALWAYS_INLINE Four square(const Vec<Four> &at, const double *const *place, int k)
{
  const Vec<Four> d = at - load<Four>(place, k);
  return dot(d, d);
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
    const Vec<Four> at{all_lanes(place[0][one]), all_lanes(place[1][one]), all_lanes(place[2][one])};
    const int near = bits(square(at, place, first) < load<Four>(all.reach2 + STRIP * n));
    lanes[some] = {n, near};
    some += near != 0;
  }
  int many = 0;
  for (int n = 0; n < some; ++n) many = append(lanes[n].bits, STRIP * lanes[n].strip, found, many);
  return many;
}

int within(const double *const *place, int from, int to, const double *x, double range2, int *found)
{
  const Vec<Four> at{all_lanes(x[0]), all_lanes(x[1]), all_lanes(x[2])};
  int many = 0;
  for (int k = from; k < to; k += STRIP) {
    const int wanted = to - k < STRIP ? (1 << (to - k)) - 1 : -1;
    many = append(bits(square(at, place, k) < range2) & wanted, k, found, many);
  }
  return many;
}

}    // namespace
}    // namespace mdanim

#endif
