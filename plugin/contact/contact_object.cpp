// SPDX-License-Identifier: GPL-2.0-only

#include "contact/contact_object.h"

#include <algorithm>
#include <limits>

namespace mdanim {

bool NearPoints::add_carriers(const ContactObject &owner, const SurfacePoint &point, const Vec3 &X)
{
  const ContactBody &body = *owner.body;
  const MapWeights weights = trilinear(X, {point.cell[0], point.cell[1], point.cell[2]}, body);
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) {
        const double weight = weights.axis[0].w[i] * weights.axis[1].w[j] * weights.axis[2].w[k];
        if (weight == 0.0) continue;
        const int slot = owner.slot[body.place(point.cell[0] + i, point.cell[1] + j, point.cell[2] + k)];
        if (slot < 0) return false;
        carriers.push_back({slot, weight});
      }
  return true;
}

bool NearPoints::add(const ContactObject &owner, int number)
{
  const SurfacePoint &point = owner.body->points()[number];
  const std::size_t before = carriers.size();
  bool all = add_carriers(owner, point, point.at);
  const int middle = static_cast<int>(carriers.size());
  if (all && point.kind == PointKind::SHARP) all = add_carriers(owner, point, point.centre);
  if (!all) {
    carriers.resize(before);
    return false;
  }
  near.push_back({number, static_cast<int>(before), middle, static_cast<int>(carriers.size())});
  return true;
}

PointFinder::PointFinder(const ContactObject &owner, const ContactArrays &arrays)
    : grid([](int) { return static_cast<const double *>(nullptr); }, 0, 1.0)
{
  NearPoints one;
  for (int p = 0; p < static_cast<int>(owner.body->points().size()); ++p) {
    one.clear();
    if (!one.add(owner, p)) continue;
    number.push_back(p);
    place.push_back(one.place(0, arrays.place()));
  }
  grid = Grid([this](int n) { return &place[n].x; }, static_cast<int>(place.size()), 2.0 * owner.body->spacing());
}

std::vector<int> PointFinder::inside(const Box &box) const
{
  std::vector<int> found;
  grid.inside(box, [&](int slot) {
    if (box.contains(&place[grid.order()[slot]].x)) found.push_back(number[grid.order()[slot]]);
  });
  std::sort(found.begin(), found.end());
  return found;
}

OuterCells::OuterCells(const ContactObject &owner, const ContactArrays &arrays)
    : grid([](int) { return static_cast<const double *>(nullptr); }, 0, 1.0)
{
  const ContactBody &body = *owner.body;
  for (int k = 0; k < body.count(2); ++k)
    for (int j = 0; j < body.count(1); ++j)
      for (int i = 0; i < body.count(0); ++i) {
        if (!body.is_outer(i, j, k)) continue;
        const int low = owner.slot[body.place(i, j, k)], high = owner.slot[body.place(i + 1, j + 1, k + 1)];
        if (low < 0 || high < 0) continue;
        cell.push_back({i, j, k});
        middle.push_back(0.5 * (arrays.place()[low].value + arrays.place()[high].value));
      }
  grid = Grid([this](int n) { return &middle[n].x; }, static_cast<int>(middle.size()), SEARCHED * body.spacing());
}

std::array<int, 3> OuterCells::nearest(const Vec3 &x) const
{
  int best = -1;
  double least = std::numeric_limits<double>::infinity();
  grid.around(&x.x, [&](int slot) {
    const int n = grid.order()[slot];
    const Vec3 d = middle[n] - x;
    if (dot(d, d) < least || (dot(d, d) == least && n < best)) least = dot(d, d), best = n;
  });
  return best < 0 ? std::array<int, 3>{-1, -1, -1} : cell[best];
}

}    // namespace mdanim
