// SPDX-License-Identifier: GPL-2.0-only

#include "contact/outline.h"

#include <algorithm>

namespace mdanim {

// Weights of particles in any place of the surface over the largest ones of points: a search may find a cell beside the one that
// carries a point.
static constexpr double MORE = 1.5;
static constexpr double STIRRED = 0.1;    // cells, after which the map is fitted again
static constexpr double FLAT = 1e-3;      // of particles that are about in one plane

void Outline::begin(const ContactBody &body, const std::vector<Vec3> &grid, const PaddedVec3 *place)
{
  forget();
  weights = MORE * body.leverage();
  renewed = STIRRED * body.spacing();
  const Vec3 &half = body.ellipsoid()->half;
  const auto scaled = [&half](const Vec3 &X) { return Vec3{X.x / half.x, X.y / half.y, X.z / half.z}; };
  Vec3 mean;
  for (const Vec3 &X : grid) mean += X;
  mean = (1.0 / static_cast<double>(grid.size())) * mean;
  centre = scaled(body.ellipsoid()->middle - mean);
  Spot<double> moments;
  for (const Vec3 &X : grid) {
    const Vec3 v = scaled(X - mean);
    moments.J[0] += v.x * v, moments.J[1] += v.y * v, moments.J[2] += v.z * v;
    all.push_back({v, {}});
  }
  const double whole = moments.J[0].x * moments.J[1].y * moments.J[2].z;
  moments.invert();
  if (!(moments.det > FLAT * whole)) return forget();
  for (Fitted &one : all) one.weight = moments.to_material(one.at);
  fit(place);
}

void Outline::fit(const PaddedVec3 *place)
{
  middle = {};
  for (std::size_t n = 0; n < all.size(); ++n) middle += place[n].value;
  middle = (1.0 / static_cast<double>(all.size())) * middle;
  Spot<double> map;
  for (std::size_t n = 0; n < all.size(); ++n) {
    const Vec3 &w = all[n].weight, x = place[n].value - middle;
    map.J[0] += w.x * x, map.J[1] += w.y * x, map.J[2] += w.z * x;
  }
  map.invert();
  double square = 0.0;
  for (std::size_t n = 0; n < all.size(); ++n) {
    const Vec3 off = place[n].value - middle - map.to_space(all[n].at);
    square = std::max(square, dot(off, off));
  }
  std::copy(map.K, map.K + 3, into);
  beside = weights * std::sqrt(square);
  stirred = 0.0;
  has_map = map.det > 0.0;
}

void Outline::follow(const Vec3 &way, double stir, const PaddedVec3 *place)
{
  if (all.empty()) return;
  middle += way, stirred += stir, beside += MORE * stir;
  if (!(stirred <= renewed)) fit(place);
}

}    // namespace mdanim
