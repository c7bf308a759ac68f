// SPDX-License-Identifier: GPL-2.0-only
// The budget computed from displacements.

#include "passes/displacement_budget.h"

#include <utility>

namespace mdanim {

void DisplacementBudget::set_alone()
{
  alone = true;
  least = nullptr;
}

void DisplacementBudget::set_ranks(Least over_ranks)
{
  alone = false;
  least = std::move(over_ranks);
}

void DisplacementBudget::set_limits(double half, const SafeDisplacement &participants)
{
  half_skin = half;
  double found[] = {participants.absolute, participants.relative, 1.0, 1.0, 1.0};
  if (!alone) {
    for (int d = 0; d < 3; ++d) found[2 + d] = (shares[d].high - shares[d].low) / (shares[d].box_high - shares[d].box_low);
    least(found, 5);
  }
  std::copy(found + 2, found + 5, narrowest);
  limits = {std::max(half, found[0]), std::max(half, found[1])};
}

// The distance between two particles has not shrunk by more than the diagonal of the box around all displacements. So each has
// used up half of it, apart from drift.
void DisplacementBudget::set_left(const Moved &here)
{
  Box all[] = {here.displacement, here.now};
  if (!alone) least(all[0].bound, 12);
  const double gone = std::sqrt(here.most);
  left = std::min(limits.absolute - gone, limits.relative - std::min(gone, 0.5 * all[0].diagonal()));
  if (!alone) left = std::max(half_skin - gone, std::min(left, way_to_strangers(here.now, all[1])));
}

// How much farther this rank's particles, which are within `own`, may go before one may have crossed half a rank unseen. LAMMPS
// hands particles on to neighbouring ranks only; these have their shares of the box around all particles, `all`, at that time.
double DisplacementBudget::way_to_strangers(const Box &own, const Box &all) const
{
  double way = std::numeric_limits<double>::max();
  for (int d = 0; d < 3 && !own.empty(); ++d) {
    const auto &[box_low, box_high, low, high, follows_low, follows_high] = shares[d];
    const double low_now = follows_low ? all.low(d) : box_low;
    const double length = (follows_high ? all.high(d) : box_high) - low_now, stretch = length / (box_high - box_low);
    const double half = 0.5 * narrowest[d] * length;
    if (low > box_low) way = std::min(way, own.low(d) - (low_now + stretch * (low - box_low)) + half);
    if (high < box_high) way = std::min(way, low_now + stretch * (high - box_low) - own.high(d) + half);
  }
  return 0.5 * way;    // particle and share may move towards each other
}

bool DisplacementBudget::spend(double way)
{
  left -= way;
  if (!alone) least(&left, 1);
  return left > 0.0;
}

void DisplacementBudget::begin(long build)
{
  if (begun_with == build) return;
  whole = left;
  begun_with = build;
}

}    // namespace mdanim
