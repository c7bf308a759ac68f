// SPDX-License-Identifier: GPL-2.0-only
// Tests which particles are near each other: the interface to the vector code (pair_filter_of_set.cpp). Plain data only;
// simd/of_set.h says why.

#pragma once

namespace mdanim {

// A particle and STRIP others that stand side by side, some of which make pairs with it: pair STRIP * n + k is `one` and the k-th
// other of strip n.
constexpr int STRIP = 4;
struct Strip {
  int one, first;
};

// The others of a strip that are near, one bit for each.
struct StripMask {
  int strip, bits;
};

constexpr double NO_PAIR = -__builtin_inf();
struct Candidates {
  const double *const *place;    // of particles, all x, all y, all z
  const Strip *strip;
  int strips;
  const double *reach2;    // square of the reach of every pair, NO_PAIR where there is none
  StripMask *lanes;        // room for one strip more than there are
  double *least;           // gets the least of r^2 - reach^2 of all pairs
};

// The functions for one set of instructions; all sets give the same answers.
struct PairFilter {
  // Numbers of the pairs in reach, ascending; returns how many. There must be room for all pairs and STRIP more.
  int (*in_reach)(const Candidates &, int *pair);
  // Places from `from` to `to` - 1 that are less than sqrt(range2) away from `at`, ascending; returns and needs room as
  // in_reach().
  int (*within)(const double *const *place, int from, int to, const double *at, double range2, int *found);
};

}    // namespace mdanim
