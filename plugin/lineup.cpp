// SPDX-License-Identifier: GPL-2.0-only
// Particles and springs brought into tag order.

#include "lineup.h"

#include <algorithm>

namespace mdanim {

Lineup::Lineup(int nlocal, int nall, const int *tag, const BondRows &bonds) : law(*bonds.law)
{
  const SpringRows &here = *bonds.rows;
  const auto [lowest, highest] = std::minmax_element(tag, tag + nall);
  std::vector<int> of_tag(nall ? *highest - *lowest + 1 : 0, -1);    // no longer than LAMMPS's own map
  for (int i = 0; i < nlocal; ++i) of_tag[tag[i] - *lowest] = i;
  for (int i = 0; i < nlocal; ++i)
    for (const SpringRows::Link &link : here[i]) of_tag[tag[i + link.offset] - *lowest] = i + link.offset;
  for (const int i : of_tag)
    if (i >= 0) index.push_back(i);

  std::vector<int> place(nall, -1);    // in the line
  name.reserve(size());
  for (int s = 0; s < size(); ++s) {
    const int i = index[s];
    place[i] = s;
    name.push_back(i < nlocal ? tag[i] : -tag[i]);
  }

  // A spring belongs to its lower end, which may be another rank's. From the highest own particle down all partners come
  // descending.
  std::vector<int> first(size() + 1, 0);
  const auto each = [&](auto visit) {
    for (int s = size() - 1; s >= 0; --s) {
      const int i = index[s];
      if (i >= nlocal) continue;
      int lower = here.lower(i);
      for (const SpringRows::Link &link : here[i]) {
        const int j = i + link.offset;
        if (lower-- <= 0) visit(s, place[j], link.type);
        else if (j >= nlocal) visit(place[j], s, link.type);
      }
    }
  };
  each([&](int low, int, int) { ++first[low + 1]; });
  for (int s = 0; s < size(); ++s) first[s + 1] += first[s];
  std::vector<SpringRows::Link> link(first.back());
  std::vector<int> next(first.begin(), first.end() - 1);
  each([&](int low, int high, int type) { link[next[low]++] = {high - low, type}; });
  rows = SpringRows(size());
  SpringRows::Row row;
  for (int s = 0; s < size(); ++s) {
    row.link.assign(link.begin() + first[s], link.begin() + first[s + 1]);
    rows.add(row);
  }
  rows.close();
}

HalfBonds Lineup::halves() const { return {&rows, law.data()}; }

bool Lineup::same_springs(const Lineup &other) const
{
  return name == other.name && rows == other.rows && law == other.law;
}

std::size_t Lineup::bytes() const
{
  return (index.capacity() + name.capacity()) * sizeof(int) + rows.bytes() + law.capacity() * sizeof(Law);
}

}    // namespace mdanim
