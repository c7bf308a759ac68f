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
  settle_rest(account);
}

void LateSums::settle_bodies(const Solid *first, const Solid *end) const
{
  const auto is_mine = [=](const Solid *one) { return one >= first && one < end; };
  for (const TouchPush &one : pushes) {
    if (is_mine(one.a)) one.add_to_a();
    if (one.b && is_mine(one.b)) one.add_to_b();
  }
  for (const TouchBound &one : bounds)
    if (is_mine(one.one)) one.add();
}

void LateSums::settle_rest(TouchAccount &account) const
{
  for (const AccountTerm &one : terms) *one.sum += one.more;
  for (Solid *one : carried) one->is_carried = true;
  account.deepest = std::max(account.deepest, deepest);
}

// Each sum has its terms part by part. Threads go over all pushes, and each adds those to some of the bodies.
void TouchThreads::settle(int parts, std::vector<Solid> &solids, TouchAccount &account) const
{
  constexpr double NS_OF_PUSH = 20.0;
  double ns = 0.0;
  bool in_parts = true;
  for (int n = 0; n < parts; ++n) {
    ns += NS_OF_PUSH * static_cast<double>(late[n].size());
    in_parts = in_parts && late[n].comes_in_parts();
  }
  if (!in_parts || !threads.pays(ns)) {
    for (int n = 0; n < parts; ++n) late[n].settle(solids, account);
    return;
  }
  const auto many = static_cast<std::size_t>(std::min(threads.most(ns), Team::MOST_TASKS - 1));
  const auto before = [&](std::size_t share) { return solids.data() + solids.size() * share / many; };
  threads.each(static_cast<int>(many) + 1, ns, [&](int share) {
    for (int n = 0; n < parts; ++n)
      if (const auto of_bodies = static_cast<std::size_t>(share); of_bodies < many)
        late[n].settle_bodies(before(of_bodies), before(of_bodies + 1));
      else
        late[n].settle_rest(account);
  });
}

}    // namespace mdanim
