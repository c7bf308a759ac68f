// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/near_solids.h"

#include "geometry/boxes.h"

#include <algorithm>
#include <utility>

namespace mdanim {

static constexpr double SKIN = 0.1;    // over the thickness of the largest body that moves

void NearSolids::update(const std::vector<Solid> &solids, const Pairs &excluded)
{
  bool is_old = listed_at.size() != solids.size();
  for (std::size_t n = 0; n < solids.size() && !is_old; ++n) {
    const Vec3 way = solids[n].centre - listed_at[n];
    is_old = dot(way, way) > 0.25 * skin * skin;
  }
  if (is_old) list(solids, excluded);
}

static bool are_near(const Solid &a, const Solid &b, double skin)
{
  const Vec3 between = a.centre - b.centre;
  const double reach = a.shape.bound() + b.shape.bound() + skin;
  return !(a.held && b.held) && dot(between, between) < reach * reach;
}

// Pairs in contact stay: the ramps about edges act beyond the spheres.
void NearSolids::list(const std::vector<Solid> &solids, const Pairs &excluded)
{
  skin = 0.0;
  for (const Solid &one : solids)
    if (!one.held) skin = std::max(skin, SKIN * one.shape.thin());
  listed_at.clear();
  std::vector<Box> boxes(solids.size());    // around the spheres
  for (std::size_t n = 0; n < solids.size(); ++n) {
    const Vec3 &centre = solids[n].centre;
    listed_at.push_back(centre);
    const double middle[3] = {centre.x, centre.y, centre.z};
    boxes[n].include(middle);
    boxes[n] = boxes[n].grown(solids[n].shape.bound());
  }
  std::vector<std::pair<int, int>> found;
  for (const auto &[a, b] : meeting_pairs(boxes, skin))
    if (are_near(solids[a], solids[b], skin) && !excluded.count({solids[a].id, solids[b].id})) found.emplace_back(a, b);
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
