// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/late_sums.h"

#include "rigid/pair.h"

#include <algorithm>

namespace mdanim {

void LateSums::clear()
{
  pushes.clear(), bounds.clear(), terms.clear(), kept.clear(), carried.clear();
  deepest = 0.0;
}

void LateSums::add(const TouchPush &one) { pushes.push_back(one); }

void LateSums::add(const TouchBound &one) { bounds.push_back(one); }

void LateSums::add(double &sum, double more)
{
  if (more != 0.0) terms.push_back({&sum, more});
}

void LateSums::settle(std::vector<Solid> &solids, TouchAccount &account) const
{
  std::size_t next = 0;
  const auto add_until = [&](std::size_t end) {
    for (; next < end; ++next) pushes[next].add();
  };
  for (const KeptPair &one : kept) {
    add_until(one.from);
    one.pair->keep(solids[one.pair->a], solids[one.pair->b], [&] { add_until(one.end); });
  }
  add_until(pushes.size());
  for (const TouchBound &one : bounds) one.add();
  for (const AccountTerm &one : terms) *one.sum += one.more;
  for (Solid *one : carried) one->is_carried = true;
  account.deepest = std::max(account.deepest, deepest);
}

}    // namespace mdanim
