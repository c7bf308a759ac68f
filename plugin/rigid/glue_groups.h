// SPDX-License-Identifier: GPL-2.0-only
// Groups of bodies that glue holds together at the start. Records name a body by its place in its group: between its bodies
// others may lie, which are not in every instance.

#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace mdanim {

struct GlueGroups {
  std::vector<std::vector<int>> groups;    // ascending bodies
  std::vector<int> group, place;           // of each body of a group: its number, and the place in it

  GlueGroups() = default;
  GlueGroups(std::vector<std::vector<int>> given, std::size_t bodies) : groups(std::move(given)), group(bodies), place(bodies)
  {
    for (std::size_t g = 0; g < groups.size(); ++g)
      for (std::size_t k = 0; k < groups[g].size(); ++k)
        group[groups[g][k]] = static_cast<int>(g), place[groups[g][k]] = static_cast<int>(k);
  }
};

}    // namespace mdanim
