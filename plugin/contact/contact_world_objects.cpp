// SPDX-License-Identifier: GPL-2.0-only
// The objects of a run and the laws of their materials.

#include "contact/contact_world.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

namespace mdanim {

static constexpr double ALONE = 2.0;     // stiffness where only the dense points of one body act, over that of points of both
static constexpr double ONSET = 0.05;    // eps over the spacing

void ContactWorld::take(std::vector<ContactObject> now, std::vector<char> moves)
{
  for (ContactObject &one : all) clear_forces(one);    // the new objects have no forces yet
  listed = false;
  active.clear(), costs.assign(1, 0);
  std::set<int> same;
  for (const ContactObject &one : now)
    if (const ContactObject *before = with_id(one.id); before && one.has_points_of(*before)) same.insert(one.id);
  for (auto field = fields.begin(); field != fields.end();)
    field = same.count(field->first.first) && same.count(field->first.second) ? std::next(field) : fields.erase(field);
  for (auto field = plane_fields.begin(); field != plane_fields.end();)
    field = same.count(field->first.first) ? std::next(field) : plane_fields.erase(field);
  all = std::move(now);
  movable = std::move(moves);
  number_of.clear();
  widest = 0.0;
  for (std::size_t n = 0; n < all.size(); ++n) {
    number_of[all[n].id] = static_cast<int>(n);
    widest = std::max({widest, ContactField::stands_out(*all[n].body, *all[n].body), 1.2 * all[n].body->spacing()});
  }
  renew_laws();
}

const ContactObject *ContactWorld::with_id(int id) const
{
  const auto found = number_of.find(id);
  return found == number_of.end() ? nullptr : &all[found->second];
}

const ContactObject *ContactWorld::misfit(const std::vector<ContactObject> &now) const
{
  std::set<int> in_touch;
  for (const auto &[ids, contacts] : pair_contacts()) in_touch.insert({ids.first, ids.second});
  for (const auto &[id, contacts] : plane_contacts()) in_touch.insert(id);
  for (const ContactObject &one : now)
    if (const ContactObject *before = with_id(one.id); before && in_touch.count(one.id) && !one.has_points_of(*before))
      return &one;
  return nullptr;
}

// --- laws ---

// `density` is that of the lighter body that can move, because that one swings.
ContactLaw ContactWorld::law(const ContactObject &owner, double density, double kappa, double friction, double damping) const
{
  const double h = owner.body->spacing();
  return {kappa, ONSET * h, friction, damping > 0.0 ? 2.0 * damping * std::sqrt(0.5 * kappa * density * h) / kappa : 0.0};
}

ContactWorld::LawsOfPair ContactWorld::laws_of_pair(int a, int b) const
{
  const ContactObject &lower = all[a], &higher = all[b];
  const double h = std::max(lower.body->spacing(), higher.body->spacing());
  const bool both = lower.body->is_cuboid() == higher.body->is_cuboid();
  const double kappa =
      (both ? 1.0 : ALONE) * settings.stiffness * 2.0 * lower.young * higher.young / (lower.young + higher.young) / h;
  double friction = std::sqrt(lower.friction * higher.friction), damping = friction > 0.0 ? settings.damping : 0.0;
  if (const auto own = settings.pairs.find({lower.id, higher.id}); own != settings.pairs.end())
    friction = own->second.friction, damping = own->second.damping;
  double density = movable[a] ? lower.density : higher.density;
  if (movable[b]) density = std::min(density, higher.density);
  return {law(lower, density, kappa, friction, damping), law(higher, density, kappa, friction, damping)};
}

ContactWorld::Both ContactWorld::new_pair(int a, int b)
{
  const LawsOfPair laws = laws_of_pair(a, b);
  return {{all[a], all[b], laws.lower}, {all[b], all[a], laws.higher}};
}

ContactLaw ContactWorld::law_at_plane(int n) const
{
  const ContactObject &one = all[n];
  const double kappa = (one.body->is_cuboid() ? 1.0 : ALONE) * settings.stiffness * one.young / one.body->spacing();
  return law(one, one.density, kappa, one.friction, one.friction > 0.0 ? settings.damping : 0.0);
}

PlaneField ContactWorld::new_plane(int n, int plane) { return {all[n], plane, settings.planes[plane], law_at_plane(n)}; }

// Takes changes of materials since contacts began into account.
void ContactWorld::renew_laws()
{
  for (auto &[key, both] : fields) {
    const LawsOfPair laws = laws_of_pair(number_of.at(key.first), number_of.at(key.second));
    both.lower.use(laws.lower);
    both.higher.use(laws.higher);
  }
  for (auto &[key, field] : plane_fields) field.use(law_at_plane(number_of.at(key.first)));
}

}    // namespace mdanim
