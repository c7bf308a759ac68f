// SPDX-License-Identifier: GPL-2.0-only
// Boxes of objects, and which of them meet.
// Wcislo 1999, eq. (3.14): S(A) = axis-aligned bounding box of the particles of A; (3.15): S(A) and S(B)
// intersect.

#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace mdanim {

// Negated upper corners, so that one MPI_MIN over all six numbers unites boxes.
struct Box {
  double bound[6] = {FAR, FAR, FAR, FAR, FAR, FAR};    // xlo ylo zlo -xhi -yhi -zhi; empty at first

  double low(int d) const { return bound[d]; }
  double high(int d) const { return -bound[3 + d]; }
  bool empty() const { return bound[0] == FAR; }
  double edge() const { return std::max({high(0) - low(0), high(1) - low(1), high(2) - low(2)}); }

  double diagonal() const
  {
    const double x = high(0) - low(0), y = high(1) - low(1), z = high(2) - low(2);
    return empty() ? 0.0 : std::sqrt((x * x + y * y) + z * z);
  }

  void include(const double *x)
  {
    for (int d = 0; d < 3; ++d) {
      bound[d] = std::min(bound[d], x[d]);
      bound[3 + d] = std::min(bound[3 + d], -x[d]);
    }
  }
  void unite(const Box &b)
  {
    for (int k = 0; k < 6; ++k) bound[k] = std::min(bound[k], b.bound[k]);
  }
  Box grown(double by) const
  {
    Box b = *this;
    for (double &side : b.bound) side -= by;
    return b;
  }
  bool contains(const double *x) const
  { return x[0] >= low(0) && x[0] <= high(0) && x[1] >= low(1) && x[1] <= high(1) && x[2] >= low(2) && x[2] <= high(2); }

  static constexpr double FAR = std::numeric_limits<double>::max();
};

// Eq. (3.15) for boxes that are both grown by half of `gap`.
inline bool meet(const Box &a, const Box &b, double gap)
{
  for (int d = 0; d < 3; ++d)
    if (a.low(d) - b.high(d) > gap || b.low(d) - a.high(d) > gap) return false;
  return true;
}

inline Box intersection(const Box &a, const Box &b)
{
  Box c;
  for (int k = 0; k < 6; ++k) c.bound[k] = std::max(a.bound[k], b.bound[k]);
  return c;
}

// A grid of cubic cells over a set of points, sorted by cell. Cells are never smaller than asked, and never many more than
// points. Slot k holds point order()[k]: a copy of the points by slots is read
// in one stream.
class Grid {
 public:
  template <class Points> Grid(const Points &points, int n, double cell) : cell(cell), sorted(n)
  {
    Box all;
    for (int i = 0; i < n; ++i) all.include(points(i));
    if (n == 0) return;
    const double longest = all.edge();
    const bool one = !(longest > 0.0 && longest < Box::FAR);    // all in one place, or so far apart that the extent overflows
    this->cell = std::max(cell, longest / MOST);
    for (;;) {
      double cells = 1.0;
      for (int d = 0; d < 3; ++d) {
        origin[d] = all.low(d);
        const double across = one ? 1.0 : std::floor((all.high(d) - all.low(d)) / this->cell) + 1.0;
        count[d] = static_cast<int>(across);
        cells *= across;
      }
      if (cells <= 4.0 * n + 64.0) break;
      this->cell *= 1.5;
    }
    std::vector<size_t> home(n);
    begin.assign(static_cast<size_t>(count[0]) * count[1] * count[2] + 1, 0);
    for (int i = 0; i < n; ++i) {
      home[i] = index(place(points(i), 0), place(points(i), 1), place(points(i), 2));
      ++begin[home[i] + 1];
    }
    for (size_t c = 1; c < begin.size(); ++c) begin[c] += begin[c - 1];
    std::vector<int> at(begin.begin(), begin.end() - 1);
    for (int i = 0; i < n; ++i) sorted[at[home[i]]++] = i;
  }

  const std::vector<int> &order() const { return sorted; }

  // Calls visit(begin, end) for ranges of slots that together hold all points in the 27 cells around x.
  template <class Visit> void ranges(const double *x, Visit visit) const
  {
    if (begin.empty()) return;
    const int p[3] = {place(x, 0), place(x, 1), place(x, 2)};
    const int low = std::max(0, p[2] - 1), high = std::min(count[2] - 1, p[2] + 1);
    for (int a = std::max(0, p[0] - 1); a <= std::min(count[0] - 1, p[0] + 1); ++a)
      for (int b = std::max(0, p[1] - 1); b <= std::min(count[1] - 1, p[1] + 1); ++b)
        visit(begin[index(a, b, low)], begin[index(a, b, high) + 1]);
  }

  // Calls visit(k) for each of these slots.
  template <class Visit> void around(const double *x, Visit visit) const
  {
    ranges(x, [&](int from, int to) {
      for (int k = from; k < to; ++k) visit(k);
    });
  }

  // Calls visit(k) for slots that together hold all points in a box.
  template <class Visit> void inside(const Box &box, Visit visit) const
  {
    if (begin.empty()) return;
    int from[3], to[3];
    for (int d = 0; d < 3; ++d) {
      double corner[3];
      corner[d] = box.low(d), from[d] = place(corner, d);
      corner[d] = box.high(d), to[d] = place(corner, d);
    }
    for (int a = from[0]; a <= to[0]; ++a)
      for (int b = from[1]; b <= to[1]; ++b)
        for (int k = begin[index(a, b, from[2])]; k < begin[index(a, b, to[2]) + 1]; ++k) visit(k);
  }

 private:
  static constexpr double MOST = 1e9;    // cells in a row; an int holds more

  int place(const double *x, int d) const
  {
    const double p = (x[d] - origin[d]) / cell;
    return p > 0.0 ? static_cast<int>(std::min(p, count[d] - 1.0)) : 0;    // a cast rounds numbers that are not negative down
  }
  size_t index(int a, int b, int c) const { return (static_cast<size_t>(a) * count[1] + b) * count[2] + c; }

  double cell, origin[3] = {0.0, 0.0, 0.0};
  int count[3] = {0, 0, 0};
  std::vector<int> begin, sorted;
};

// All pairs (a < b) of boxes that meet. Up to ALL_PAIRS boxes every pair is tried. Beyond that, boxes of usual size
// are sorted into a grid by their lower corner, cells as wide as the largest of them and the gap, so that a
// partner lies in one of the 27 cells around; boxes much larger than the median (a floor, a pool) are tried
// against all.
inline std::vector<std::pair<int, int>> meeting_pairs(const std::vector<Box> &boxes, double gap)
{
  constexpr int ALL_PAIRS = 200;
  constexpr double LARGE = 4.0;
  std::vector<std::pair<int, int>> pairs;
  const auto check = [&](int a, int b) {
    if (meet(boxes[a], boxes[b], gap)) pairs.emplace_back(std::min(a, b), std::max(a, b));
  };

  std::vector<int> present;
  for (int a = 0; a < static_cast<int>(boxes.size()); ++a)
    if (!boxes[a].empty()) present.push_back(a);

  if (present.size() <= ALL_PAIRS) {
    for (size_t a = 0; a < present.size(); ++a)
      for (size_t b = a + 1; b < present.size(); ++b) check(present[a], present[b]);
    return pairs;
  }

  std::vector<double> edges;
  for (const int a : present) edges.push_back(boxes[a].edge());
  std::nth_element(edges.begin(), edges.begin() + edges.size() / 2, edges.end());
  const double limit = LARGE * edges[edges.size() / 2] + gap;

  std::vector<int> usual, large;
  double cell = 0.0;
  for (const int a : present) {
    const double reach = boxes[a].edge() + gap;
    (boxes[a].edge() > limit ? large : usual).push_back(a);
    if (boxes[a].edge() <= limit) cell = std::max(cell, reach);
  }
  const auto corner = [&](int i) { return boxes[usual[i]].bound; };
  const Grid grid(corner, static_cast<int>(usual.size()), cell);
  for (size_t a = 0; a < usual.size(); ++a)
    grid.around(boxes[usual[a]].bound, [&](int slot) {
      const int b = grid.order()[slot];
      if (b > static_cast<int>(a)) check(usual[a], usual[b]);
    });
  for (size_t a = 0; a < large.size(); ++a) {
    for (size_t b = a + 1; b < large.size(); ++b) check(large[a], large[b]);
    for (const int b : usual) check(large[a], b);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}    // namespace mdanim
