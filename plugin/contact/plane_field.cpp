// SPDX-License-Identifier: GPL-2.0-only

#include "contact/plane_field.h"

#include <algorithm>
#include <limits>

namespace mdanim {

static constexpr double AT_ONCE = -1.0;
static constexpr double NEVER = std::numeric_limits<double>::infinity();

void PlaneField::list(ContactObject &points_of, const PointFinder &finder, const ContactArrays &arrays, double reach)
{
  owner = &points_of;
  std::vector<int> points_before(near.size());
  for (std::size_t q = 0; q < near.size(); ++q) points_before[q] = near.point(q);
  const std::vector<std::uint8_t> below_before = std::move(was_below);
  near.clear(), wake.clear(), was_below.clear(), of_contact.clear();
  budget = 0.0, next = AT_ONCE;
  std::size_t before = 0, contact = 0;
  for (const int p : finder.inside(plane.within(reach), contacts)) {
    while (contact < contacts.size() && contacts[contact].point < p) ++contact;
    const bool touches = contact < contacts.size() && contacts[contact].point == p;
    while (before < points_before.size() && points_before[before] < p) ++before;
    const CarriedPoint point(*owner, p);
    if (!point.is_there) continue;
    const double above = -plane.depth(point.place(arrays.place()));
    if (!touches && above > reach) continue;
    near.add(point);
    if (touches) of_contact.push_back(near.size() - 1);
    was_below.push_back(before < points_before.size() && points_before[before] == p ? below_before[before] : 0);
    wake.push_back(touches ? NEVER : std::max(above, AT_ONCE));
  }
  keep_near(contacts, of_contact, near);
}

void PlaneField::forget()
{
  near.clear(), wake.clear(), was_below.clear(), of_contact.clear();
  budget = 0.0;
}

void PlaneField::settle(const ContactArrays &arrays)
{
  for (std::size_t q = 0; q < near.size(); ++q)
    if (wake[q] < NEVER && wake[q] <= budget) look(q, arrays, false);
  next = AT_ONCE;
}

bool PlaneField::look(std::size_t q, const ContactArrays &arrays, bool may_begin)
{
  const Vec3 x = near.place(q, arrays.place());
  const double depth = plane.depth(x);
  const bool was = was_below[q];
  was_below[q] = depth > 0.0;
  if (depth <= 0.0 || !may_begin) {
    wake[q] = budget - std::min(depth, 0.0);
    return false;
  }
  PlaneContact contact{};
  contact.point = near.point(q);
  contact.plane = number;
  contact.anchor = x;
  contact.memory.depth = depth;
  contact.memory.offset = was ? depth : 0.0;
  const auto where = std::lower_bound(of_contact.begin(), of_contact.end(), q);
  contacts.insert(contacts.begin() + (where - of_contact.begin()), contact);
  of_contact.insert(where, q);
  wake[q] = NEVER;
  return true;
}

void PlaneField::add_forces(ContactArrays &arrays, double dt, ContactAccount &account)
{
  budget += owner->stir - dot(plane.normal(), owner->way);
  on_plane = {};
  const bool moves = dt > 0.0;
  if (moves && next < budget) {
    next = NEVER;
    for (std::size_t q = 0; q < wake.size(); ++q) {
      if (wake[q] < budget) look(q, arrays, true);
      next = std::min(next, wake[q]);
    }
  }
  const Vec3 downward = -1.0 * plane.normal();    // gradient of the depth
  std::size_t left = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    PlaneContact contact = contacts[c];
    const std::size_t q = of_contact[c];
    const Vec3 x = near.place(q, arrays.place());
    const double depth = plane.depth(x);
    if (depth <= 0.0) {
      if (!moves) continue;
      account.heat += contact.memory.stick_energy;
      account.damped += last_damping_work(contact.memory, depth);
      was_below[q] = 0;
      wake[q] = budget - depth;
      next = std::min(next, wake[q]);
      continue;
    }
    const double area = owner->body->points()[near.point(q)].area;
    ContactForce<double> force = contact_pressure(law, area, 1.0, depth, dt, contact.memory);
    if (law.friction > 0.0) {
      Vec3 away = x - contact.anchor;
      away -= dot(away, downward) * downward;
      contact_friction(law, area, 1.0, away, downward, dt, contact.memory, force);
      contact.anchor = x - force.kept * away;
    }
    const Vec3 on_point = -force.press * downward + force.pull + force.drag;
    near.add_force(q, on_point, arrays.force());
    on_plane -= on_point;
    account.energy += force.surface_energy;
    account.stick_energy += contact.memory.stick_energy;
    account.heat += force.heat;
    account.damped += force.damped;
    account.deepest = std::max(account.deepest, depth);
    ++account.touching;
    if (!moves) continue;
    contacts[left] = contact, of_contact[left] = of_contact[c];
    ++left;
  }
  if (moves) contacts.resize(left), of_contact.resize(left);
}

std::size_t PlaneField::bytes() const
{
  return near.bytes() + wake.capacity() * sizeof(double) + was_below.capacity() + contacts.capacity() * sizeof(PlaneContact) +
         of_contact.capacity() * sizeof(std::size_t);
}

}    // namespace mdanim
