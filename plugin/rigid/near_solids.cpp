// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/near_solids.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>

namespace mdanim {

static constexpr double SKIN = 0.1;    // over the thickness of the largest body that moves

void NearSolids::update(const std::vector<Solid> &solids)
{
  bool is_old = listed_at.size() != solids.size();
  for (std::size_t n = 0; n < solids.size() && !is_old; ++n) {
    const Vec3 way = solids[n].centre - listed_at[n];
    is_old = dot(way, way) > 0.25 * skin * skin;
  }
  if (is_old) list(solids);
}

static bool are_near(const Solid &a, const Solid &b, double skin)
{
  const Vec3 between = a.centre - b.centre;
  const double reach = a.shape.bound() + b.shape.bound() + skin;
  return !(a.held && b.held) && dot(between, between) < reach * reach;
}

// Bodies sorted into cells that are wider than most of them; those that are larger meet all others. Pairs in contact stay: the
// ramps about edges act beyond the spheres.
void NearSolids::list(const std::vector<Solid> &solids)
{
  const int count = static_cast<int>(solids.size());
  skin = 0.0;
  double widest = 0.0;
  for (const Solid &one : solids) {
    if (one.held) continue;
    skin = std::max(skin, SKIN * one.shape.thin());
    widest = std::max(widest, one.shape.bound());
  }
  const double cell = 2.0 * widest + skin;
  listed_at.clear();
  std::vector<std::pair<int, int>> found;
  std::vector<int> large;
  std::unordered_map<std::uint64_t, std::vector<int>> cells;
  const auto cell_of = [cell](double x) { return static_cast<std::int64_t>(std::floor(x / cell)); };
  const auto key = [](std::int64_t i, std::int64_t j, std::int64_t k) {
    constexpr std::uint64_t PART = (1u << 21) - 1;
    return (static_cast<std::uint64_t>(i) & PART) << 42 | (static_cast<std::uint64_t>(j) & PART) << 21 |
           (static_cast<std::uint64_t>(k) & PART);
  };
  for (int n = 0; n < count; ++n) {
    const Solid &one = solids[n];
    listed_at.push_back(one.centre);
    const auto meet = [&](int other) {
      if (are_near(solids[other], one, skin)) found.emplace_back(other, n);
    };
    if (2.0 * one.shape.bound() + skin > cell) {
      for (int other = 0; other < n; ++other) meet(other);
      large.push_back(n);
      continue;
    }
    for (const int other : large) meet(other);
    const std::int64_t at[3] = {cell_of(one.centre.x), cell_of(one.centre.y), cell_of(one.centre.z)};
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j)
        for (int k = -1; k <= 1; ++k)
          if (const auto some = cells.find(key(at[0] + i, at[1] + j, at[2] + k)); some != cells.end())
            for (const int other : some->second) meet(other);
    cells[key(at[0], at[1], at[2])].push_back(n);
  }
  for (const SolidPair &pair : pairs)
    if (!pair.touches.empty()) found.emplace_back(pair.a, pair.b);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());

  std::vector<SolidPair> now(found.size());
  auto before = pairs.begin();
  for (std::size_t n = 0; n < found.size(); ++n) {
    const auto is_lower = [&](const SolidPair &pair) { return std::pair{pair.a, pair.b} < found[n]; };
    while (before != pairs.end() && is_lower(*before)) ++before;
    if (before != pairs.end() && before->a == found[n].first && before->b == found[n].second) {
      now[n] = std::move(*before);
    } else {
      now[n].a = found[n].first;
      now[n].b = found[n].second;
    }
  }
  pairs = std::move(now);
}

}    // namespace mdanim
