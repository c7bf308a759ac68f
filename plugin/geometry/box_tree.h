// SPDX-License-Identifier: GPL-2.0-only
// A tree of boxes that stay where they are: which of them meet another one.

#pragma once

#include "geometry/boxes.h"

#include <vector>

namespace mdanim {

class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(const std::vector<Box> &boxes);

  // Calls visit(number) for each box that meets this one, in the order of the tree.
  template <class Visit> void meeting(const Box &box, const Visit &visit) const
  {
    if (!nodes.empty()) meeting(0, box, visit);
  }

 private:
  struct Node {
    Box box;
    int first = 0, count = 0;    // of a leaf: its boxes
    int second = 0;              // of others: the second child; the first one follows
  };
  static constexpr int LEAF = 4;    // boxes of a leaf at most

  int make(const std::vector<Box> &boxes, int begin, int end);
  template <class Visit> void meeting(int number, const Box &box, const Visit &visit) const
  {
    const Node &node = nodes[number];
    if (!meet(node.box, box, 0.0)) return;
    if (node.count == 0) {
      meeting(number + 1, box, visit);
      meeting(node.second, box, visit);
      return;
    }
    for (int k = node.first; k < node.first + node.count; ++k)
      if (meet(leaves[k], box, 0.0)) visit(order[k]);
  }

  std::vector<Node> nodes;
  std::vector<int> order;
  std::vector<Box> leaves;    // boxes in that order
};

}    // namespace mdanim
