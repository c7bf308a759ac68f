// SPDX-License-Identifier: GPL-2.0-only
// Finding equal rows.

#include "engine/spring_rows.h"

#include "engine/hash.h"

#include <algorithm>
#include <cstdint>

namespace mdanim {

bool SpringRows::same(int k, const Row &row) const
{
  const Links own = links(k);
  return row.lower == lowers[k] && std::equal(row.link.begin(), row.link.end(), own.begin(), own.end());
}

void SpringRows::add(const Row &row)
{
  all += row.link.size();
  if (!kind.empty() && same(kind.back(), row)) {    // mostly
    kind.push_back(kind.back());
    return;
  }
  std::uint64_t hash = HASH_OF_NOTHING + row.lower;
  for (const Link &link : row.link)
    hash = hash_with(hash, static_cast<std::uint64_t>(link.offset) << 32 ^ static_cast<std::uint32_t>(link.type));
  const auto [begin, end] = known.equal_range(hash);
  const auto found = std::find_if(begin, end, [&](const auto &entry) { return same(entry.second, row); });
  if (found != end) {
    kind.push_back(found->second);
    return;
  }
  kind.push_back(static_cast<int>(lowers.size()));
  known.emplace(hash, kind.back());
  lowers.push_back(row.lower);
  distinct.insert(distinct.end(), row.link.begin(), row.link.end());
  first.push_back(static_cast<int>(distinct.size()));
}

std::size_t SpringRows::bytes() const
{ return (kind.capacity() + first.capacity() + lowers.capacity()) * sizeof(int) + distinct.capacity() * sizeof(Link); }

}    // namespace mdanim
