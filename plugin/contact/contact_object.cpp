// SPDX-License-Identifier: GPL-2.0-only

#include "contact/contact_object.h"

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

}    // namespace mdanim
