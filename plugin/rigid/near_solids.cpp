// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/near_solids.h"

#include "geometry/boxes.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace mdanim {

static constexpr double WAY = 0.05;    // that a body may go while a list holds, over its thickness

bool NearSolids::update(const std::vector<Solid> &solids, const Pairs &excluded)
{
  bool is_old = listed_at.size() != solids.size();
  for (std::size_t n = 0; n < solids.size() && !is_old; ++n) {
    const Vec3 way = solids[n].centre - listed_at[n];
    is_old = dot(way, way) > ways[n] * ways[n];
  }
  if (is_old) list(solids, excluded);
  return is_old;
}

// One large body does not make the lists of all others long, and a small one does not make lists short-lived: it may go as far as
// the median of those that are free, and so may held ones, which may be driven.
void NearSolids::find_ways(const std::vector<Solid> &solids)
{
  std::vector<double> thin;
  for (const Solid &one : solids)
    if (!one.held) thin.push_back(one.shape.thin());
  const auto middle = thin.begin() + static_cast<std::ptrdiff_t>(thin.size() / 2);
  std::nth_element(thin.begin(), middle, thin.end());
  const double usual = thin.empty() ? 0.0 : *middle;
  ways.clear();
  for (const Solid &one : solids) ways.push_back(WAY * (one.held ? usual : std::max(usual, one.shape.thin())));
}

static bool are_near(const Solid &a, const Solid &b, double ways)
{
  const Vec3 between = a.centre - b.centre;
  const double reach = a.shape.bound() + b.shape.bound() + ways;
  return !(a.held && b.held) && !(a.whole != Solid::ALONE && a.whole == b.whole) && dot(between, between) < reach * reach;
}

// Pairs in contact stay: the ramps about edges act beyond the spheres.
void NearSolids::list(const std::vector<Solid> &solids, const Pairs &excluded)
{
  find_ways(solids);
  listed_at.clear();
  std::vector<Box> boxes(solids.size());    // around the spheres
  for (std::size_t n = 0; n < solids.size(); ++n) {
    const Vec3 &centre = solids[n].centre;
    listed_at.push_back(centre);
    const double middle[3] = {centre.x, centre.y, centre.z};
    boxes[n].include(middle);
    boxes[n] = boxes[n].grown(solids[n].shape.bound() + ways[n]);
  }
  std::vector<std::pair<int, int>> found;
  for (const auto &[a, b] : meeting_pairs(boxes, 0.0))
    if (are_near(solids[a], solids[b], ways[a] + ways[b]) && !excluded.count({solids[a].id, solids[b].id}))
      found.emplace_back(a, b);
  const auto near = static_cast<std::ptrdiff_t>(found.size());
  for (const SolidPair &pair : pairs)    // ascending, as those that meet
    if (!pair.touches.empty()) found.emplace_back(pair.a, pair.b);
  std::inplace_merge(found.begin(), found.begin() + near, found.end());
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

std::size_t NearSolids::bytes() const
{
  std::size_t all = pairs.capacity() * sizeof(SolidPair);
  for (const SolidPair &pair : pairs)
    all += pair.touches.capacity() * sizeof(Touch) +
           (pair.corners[0].capacity() + pair.corners[1].capacity() + pair.edges.capacity()) * sizeof(NearFeatures);
  return all;
}

}    // namespace mdanim
