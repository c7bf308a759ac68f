// SPDX-License-Identifier: GPL-2.0-only
// Particles and springs brought into tag order.

#include "lineup.h"

#include <algorithm>

namespace mdanim {

Lineup::Lineup(int nlocal, int nall, const int *tag, const BondRows &rows) : law(*rows.law)
{
  const auto [lowest, highest] = std::minmax_element(tag, tag + nall);
  std::vector<int> of_tag(nall ? *highest - *lowest + 1 : 0, -1);    // no longer than LAMMPS's own map
  for (int i = 0; i < nlocal; ++i) of_tag[tag[i] - *lowest] = i;
  for (int b = 0; b < rows.first[nlocal]; ++b) of_tag[tag[rows.partner[b]] - *lowest] = rows.partner[b];
  for (const int i : of_tag)
    if (i >= 0) index.push_back(i);

  std::vector<int> place(nall, -1);    // in the line
  name.reserve(size());
  for (int s = 0; s < size(); ++s) {
    const int i = index[s];
    place[i] = s;
    name.push_back(i < nlocal ? tag[i] : -tag[i]);
  }

  // A spring belongs to its lower end, which may be another rank's.
  first.assign(size() + 1, 0);
  const auto each = [&](auto visit) {    // from the highest own particle down, so that all partners come descending
    for (int s = size() - 1; s >= 0; --s) {
      const int i = index[s];
      if (i >= nlocal) continue;
      for (int b = rows.first[i]; b < rows.upper[i]; ++b)
        if (rows.partner[b] >= nlocal) visit(place[rows.partner[b]], s, b);
      for (int b = rows.upper[i]; b < rows.first[i + 1]; ++b) visit(s, place[rows.partner[b]], b);
    }
  };
  each([this](int low, int, int) { ++first[low + 1]; });
  for (int s = 0; s < size(); ++s) first[s + 1] += first[s];
  partner.resize(first.back());
  type.resize(first.back());
  std::vector<int> next(first.begin(), first.end() - 1);
  each([&](int low, int high, int b) {
    const int at = next[low]++;
    partner[at] = high;
    type[at] = rows.type[b];
  });
}

HalfBonds Lineup::halves() const { return {size(), first.data(), partner.data(), type.data(), law.data()}; }

bool Lineup::same_springs(const Lineup &other) const
{
  return name == other.name && first == other.first && partner == other.partner && type == other.type && law == other.law;
}

std::size_t Lineup::bytes() const
{
  return (index.capacity() + name.capacity() + first.capacity() + partner.capacity() + type.capacity()) * sizeof(int) +
      law.capacity() * sizeof(Law);
}

}    // namespace mdanim
