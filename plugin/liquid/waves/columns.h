// SPDX-License-Identifier: GPL-2.0-only
// Columns of the basin and their neighbours.

#pragma once

#include <cmath>
#include <vector>

namespace mdanim {

inline constexpr double ON_BODY = 0.5;    // cells of liquid on a body that do not make a surface yet

// The sides of a column, a span or the basin: -x, +x, -y, +y.
enum SideOf { WEST, EAST, SOUTH, NORTH };

// The column at a side; -1 beyond the basin.
inline int neighbour(int column, int side, int nx, int ny)
{
  const int x = column % nx, y = column / nx;
  switch (side) {
    case WEST:
      return x > 0 ? column - 1 : -1;
    case EAST:
      return x < nx - 1 ? column + 1 : -1;
    case SOUTH:
      return y > 0 ? column - nx : -1;
    default:
      return y < ny - 1 ? column + nx : -1;
  }
}

// Spreads knowledge to neighbours, layer by layer. find(n): whether a neighbour of n is known; take(n): n is known from now on.
// Returns the numbers that never become known.
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

// Mean of the values, not NaN, in the columns beside one; NaN where there is none.
inline double mean_beside(const std::vector<double> &values, int column, int nx, int ny)
{
  double sum = 0.0;
  int count = 0;
  for (int side = 0; side < 4; ++side) {
    const int other = neighbour(column, side, nx, ny);
    if (other < 0 || std::isnan(values[other])) continue;
    sum += values[other];
    ++count;
  }
  return sum / count;
}

// Gives columns without a value, NaN, the mean of those beside them. Returns the columns that never get one.
inline std::vector<int> fill_inward(std::vector<double> &values, const std::vector<int> &empty, int nx, int ny)
{
  std::vector<double> found(empty.empty() ? 0 : values.size());
  const auto find = [&](int column) { return !std::isnan(found[column] = mean_beside(values, column, nx, ny)); };
  return learn_inward(empty, find, [&](int column) { values[column] = found[column]; });
}

}    // namespace mdanim
