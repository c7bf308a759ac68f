// SPDX-License-Identifier: GPL-2.0-only

#include "contact/contact_laws.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

static constexpr double ALONE = 2.0;     // stiffness where only the dense points of one body act, over that of points of both
static constexpr double LINE = 0.2;      // the same of a line or a sheet of particles, of which each bears all that it meets
static constexpr double ONSET = 0.05;    // eps over the spacing: what lands flat meets many points in one step
static constexpr double ROUND = 0.0;     // that of a body which is curved everywhere, on what is flat: it meets few at once

static ContactLaw law_of(const ContactObject &owner, bool on_flat, double density, double kappa, double friction, double damping)
{
  const double h = owner.body->spacing();
  const double onset = on_flat && owner.body->is_round() ? ROUND : ONSET;
  return {kappa, onset * h, friction, damping > 0.0 ? 2.0 * damping * std::sqrt(0.5 * kappa * density * h) / kappa : 0.0};
}

ContactLaw ContactSettings::law_of_pair(const ContactObject &owner, const ContactObject &host, double density) const
{
  const bool ascend = owner.id < host.id;
  const ContactObject &lower = ascend ? owner : host, &higher = ascend ? host : owner;    // so that both laws have the same bits
  // A line or a sheet gives way as its own links do, however coarse the body is that it lies on.
  const ContactBody *const bare = lower.body->is_line() ? lower.body.get() : higher.body->is_line() ? higher.body.get() : nullptr;
  const double h = bare ? bare->spacing() : std::max(lower.body->spacing(), higher.body->spacing());
  const double part = bare ? LINE * bare->hardness() : lower.body->is_cuboid() == higher.body->is_cuboid() ? 1.0 : ALONE;
  const double kappa = part * stiffness * 2.0 * lower.young * higher.young / (lower.young + higher.young) / h;
  double mu = std::sqrt(lower.friction * higher.friction), beta = mu > 0.0 ? damping : 0.0;
  if (const auto own = pairs.find({lower.id, higher.id}); own != pairs.end())
    mu = own->second.friction, beta = own->second.damping;
  ContactLaw law = law_of(owner, host.body->is_cuboid(), density, kappa, mu, beta);
  if (!belts.empty()) law.belt = belt(host.id) - belt(owner.id);
  return law;
}

ContactLaw ContactSettings::law_at_plane(const ContactObject &one) const
{
  const double part = one.body->is_line() ? LINE : one.body->is_cuboid() ? 1.0 : ALONE;
  const double kappa = part * stiffness * one.young / one.body->spacing();
  return law_of(one, true, one.density, kappa, one.friction, one.friction > 0.0 ? damping : 0.0);
}

}    // namespace mdanim
