// SPDX-License-Identifier: GPL-2.0-only
// Tests which particles are near each other, four at a time (pair_filter.h), for one set of instructions.

#include "barrier/pair_filter.h"

#include "simd/of_set.h"
#include "simd/vectors.h"

namespace mdanim {
namespace {

static_assert(STRIP == 4, "a strip is a vector");

// Appends the numbers from `first` on whose bits are set to the `many` numbers in `found`; without a branch that cannot be
// predicted.
MDANIM_ALWAYS_INLINE int append(int bits, int first, int *found, int many)
{
  for (int lane = 0; lane < STRIP; ++lane) {
    found[many] = first + lane;
    many += bits >> lane & 1;
  }
  return many;
}

// r^2 between one place and the four from k on.
MDANIM_ALWAYS_INLINE Four square(const Vec<Four> &at, const double *const *place, int k)
{
  const Vec<Four> d = at - load<Four>(place, k);
  return dot(d, d);
}

// Most strips have no pair in reach. No strip is looked at twice. This too is without a branch.
int in_reach(const Candidates &all, int *found)
{
  const double *const place[] = {all.place[0], all.place[1], all.place[2]};
  StripMask *const lanes = all.lanes;
  const int strips = all.strips;
  int some = 0;
  Four least = constant<Four>(__builtin_inf());
  for (int n = 0; n < strips; ++n) {
    const auto [one, first] = all.strip[n];
    const Vec<Four> at{constant<Four>(place[0][one]), constant<Four>(place[1][one]), constant<Four>(place[2][one])};
    const Four beyond = square(at, place, first) - load<Four>(all.reach2 + STRIP * n);
    const int near = bits(beyond < 0.0);
    least = smaller(least, beyond);
    lanes[some] = {n, near};
    some += near != 0;
  }
  *all.least = smaller(smaller<double>(least[0], least[1]), smaller<double>(least[2], least[3]));
  int many = 0;
  for (int n = 0; n < some; ++n) many = append(lanes[n].bits, STRIP * lanes[n].strip, found, many);
  return many;
}

int within(const double *const *place, int from, int to, const double *x, double range2, int *found)
{
  const Vec<Four> at{constant<Four>(x[0]), constant<Four>(x[1]), constant<Four>(x[2])};
  int many = 0;
  for (int k = from; k < to; k += STRIP) {
    const int wanted = to - k < STRIP ? (1 << (to - k)) - 1 : -1;
    many = append(bits(square(at, place, k) < range2) & wanted, k, found, many);
  }
  return many;
}

}    // namespace

extern const PairFilter MDANIM_OF_SET(pair_filter);
const PairFilter MDANIM_OF_SET(pair_filter) = {in_reach, within};

}    // namespace mdanim
