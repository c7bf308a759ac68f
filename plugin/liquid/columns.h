// SPDX-License-Identifier: GPL-2.0-only
// Columns of the basin and those beside them.

#ifndef MDANIM_COLUMNS_H
#define MDANIM_COLUMNS_H

#include <vector>

namespace mdanim {

// The column at a side, 0 to 3: -x, +x, -y, +y; -1 beyond the basin.
inline int neighbour(int column, int side, int nx, int ny)
{
  const int x = column % nx, y = column / nx;
  switch (side) {
    case 0:
      return x > 0 ? column - 1 : -1;
    case 1:
      return x < nx - 1 ? column + 1 : -1;
    case 2:
      return y > 0 ? column - nx : -1;
    default:
      return y < ny - 1 ? column + nx : -1;
  }
}

// What is not known gets known from what is beside it, layer by layer. find(n): whether something beside n is known; take(n): n
// is known from now on. Returns what never gets known.
template <class Find, class Take> std::vector<int> learn_inward(std::vector<int> left, const Find &find, const Take &take)
{
  std::vector<int> later, now;
  while (!left.empty()) {
    now.clear();
    later.clear();
    for (const int n : left) (find(n) ? now : later).push_back(n);
    if (now.empty()) break;
    for (const int n : now) take(n);
    left.swap(later);
  }
  return left;
}

}    // namespace mdanim

#endif
