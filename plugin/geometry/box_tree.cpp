// SPDX-License-Identifier: GPL-2.0-only

#include "geometry/box_tree.h"

#include <numeric>

namespace mdanim {

BoxTree::BoxTree(const std::vector<Box> &boxes) : order(boxes.size())
{
  if (boxes.empty()) return;
  std::iota(order.begin(), order.end(), 0);
  make(boxes, 0, static_cast<int>(boxes.size()));
  for (const int number : order) leaves.push_back(boxes[number]);
}

// Halves by the middles of boxes, along the axis on which these spread most.
int BoxTree::make(const std::vector<Box> &boxes, int begin, int end)
{
  const int number = static_cast<int>(nodes.size());
  nodes.emplace_back();
  Box all, middles;
  const auto middle = [&](int k, int d) { return boxes[k].low(d) + boxes[k].high(d); };
  for (int k = begin; k < end; ++k) {
    all.unite(boxes[order[k]]);
    const double at[3] = {middle(order[k], 0), middle(order[k], 1), middle(order[k], 2)};
    middles.include(at);
  }
  nodes[number].box = all;
  if (end - begin <= LEAF) {
    nodes[number].first = begin;
    nodes[number].count = end - begin;
    return number;
  }
  int axis = 0;
  for (int d = 1; d < 3; ++d)
    if (middles.high(d) - middles.low(d) > middles.high(axis) - middles.low(axis)) axis = d;
  const int half = begin + (end - begin) / 2;
  std::nth_element(order.begin() + begin, order.begin() + half, order.begin() + end,
                   [&](int a, int b) { return middle(a, axis) != middle(b, axis) ? middle(a, axis) < middle(b, axis) : a < b; });
  make(boxes, begin, half);
  const int second = make(boxes, half, end);
  nodes[number].second = second;
  return number;
}

}    // namespace mdanim
