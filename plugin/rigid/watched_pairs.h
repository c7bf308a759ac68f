// SPDX-License-Identifier: GPL-2.0-only
// Pairs of bodies, and bodies at planes, that cannot touch before the bodies have gone some way: most of what is near. One
// comparison is all that they are asked for in a step.

#pragma once

#include "rigid/pair.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace mdanim {

class WatchedPairs {
 public:
  static constexpr double SURELY = 0.99;    // of a gap

  void forget(std::size_t bodies, std::size_t planes)
  {
    ways.assign(bodies, 0.0);
    above_until.assign(planes, std::vector<double>(bodies, -HUGE_VAL));
  }
  // Takes another list of pairs, all of which may touch.
  void take(const std::vector<SolidPair> &pairs)
  {
    watched.clear();
    for (const SolidPair &pair : pairs) watched.push_back({pair.a, pair.b});
  }
  void go(int body, double way) { ways[body] += way; }
  double gone(const SolidPair &pair) const { return ways[pair.a] + ways[pair.b]; }

  // To be called after the pair k was looked at.
  void watch(int k, const SolidPair &pair)
  { watched[k].until = pair.touches.empty() && pair.asleep > 0.0 ? pair.gone + pair.asleep : -HUGE_VAL; }
  bool may_touch(int k) const { return ways[watched[k].a] + ways[watched[k].b] >= watched[k].until; }
  // The same of a body that is this far above a plane; below 0 where it may touch it.
  void watch(int plane, int body, double above)
  { above_until[plane][body] = above > 0.0 ? ways[body] + SURELY * above : -HUGE_VAL; }
  bool may_touch(int plane, int body) const { return ways[body] >= above_until[plane][body]; }

  // Calls visit(k) for those of some pairs, or of all, that may touch, from the first one to before the end. What a pair
  // remembers is in many places of memory: it is fetched while pairs before it are looked at.
  template <class Visit>
  void each(const std::vector<int> *some, long first, long end, const std::vector<SolidPair> &pairs, const Visit &visit) const
  {
    constexpr std::size_t FIRST = 6, THEN = 3;
    std::vector<int> due;
    due.reserve(end - first);
    for (long n = first; n < end; ++n)
      if (const int k = some ? (*some)[n] : static_cast<int>(n); may_touch(k)) due.push_back(k);
    for (std::size_t n = 0; n < due.size(); ++n) {
      if (n + FIRST < due.size()) pairs[due[n + FIRST]].fetch();
      if (n + THEN < due.size()) pairs[due[n + THEN]].fetch_lists();
      visit(due[n]);
    }
  }

 private:
  struct Watch {
    int a, b;
    double until = -HUGE_VAL;    // sum of the ways of both
  };
  std::vector<double> ways;    // of bodies, no less than the farthest way of a point of each
  std::vector<Watch> watched;
  std::vector<std::vector<double>> above_until;    // by planes and bodies
};

}    // namespace mdanim
