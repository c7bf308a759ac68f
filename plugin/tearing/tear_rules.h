// SPDX-License-Identifier: GPL-2.0-only
// Springs of objects that break, and when, as a text gives it.

#pragma once

#include "tearing/law.h"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace mdanim {

// A spring whose length without load is not its rest length, or that bears another strain than its object. Particles of an object
// are counted from its lowest tag, 0.
struct TearLink {
  int low, high;
  double length, limit;    // without load; from which on it is gone
};

// A spring over two links.
struct TearOver {
  int low, middle, high;
  Spring spring;
  double length[2], limit[2];    // of the links, the lower one first
  double own;                    // its own length without load: that of both, unless they are not in a row

  LoadFree whole() const { return {spring, own}; }
  LoadFree remainder(int link) const { return remainder_of(whole(), length[link], length[0] + length[1]); }
};

// An object whose springs may break.
struct TearRules {
  double strain = 0.0;            // of springs that no link tells otherwise
  bool leaves_rest = true;        // of springs over two links, along the one that is there
  std::vector<TearLink> links;    // ascending
  std::vector<TearOver> overs;    // ascending by both ends

  const TearLink *link(int low, int high) const;    // null for none
  const TearOver *over(int low, int high) const;
  std::size_t bytes() const { return links.capacity() * sizeof(TearLink) + overs.capacity() * sizeof(TearOver); }
};

// Rules by molecule IDs. Throws std::runtime_error with the line: `name` names the file (docs/fix_mdanim_tear.md).
std::map<int, TearRules> read_tear_rules(const std::string &name, const std::string &text);

}    // namespace mdanim
