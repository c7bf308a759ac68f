// SPDX-License-Identifier: GPL-2.0-only

#include "contact/plane_field.h"

#include <algorithm>

namespace mdanim {

static constexpr double AT_ONCE = -1.0;
static constexpr double NEVER = Wakes::NEVER;

void PlaneField::list(ContactObject &points_of, const PointFinder &finder, const ContactArrays &arrays, double reach)
{
  owner = &points_of;
  std::vector<int> points_before(near.size());
  for (std::size_t q = 0; q < near.size(); ++q) points_before[q] = near.point(q);
  const std::vector<std::uint8_t> below_before = std::move(was_below);
  near.clear(), wake.clear(), was_below.clear(), of_contact.clear();
  budget = 0.0;
  std::size_t before = 0, contact = 0;
  for (const int p : finder.inside(plane.within(reach), true, contacts)) {
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
}

bool PlaneField::look(std::size_t q, const ContactArrays &arrays, bool may_begin)
{
  const Vec3 x = near.place(q, arrays.place());
  const double depth = plane.depth(x);
  const bool was = was_below[q];
  was_below[q] = depth > 0.0;
  if (depth <= 0.0 || !may_begin) {
    wake.set(q, budget - std::min(depth, 0.0));
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
  wake.set(q, NEVER);
  return true;
}

int PlaneField::cost() const
{
  constexpr std::size_t CONTACT = 30;
  return static_cast<int>(near.size() + CONTACT * contacts.size());
}

void PlaneField::look(const ContactArrays &arrays, double dt)
{
  on_plane = {};
  ahead.clear();
  budget += owner->stir - dot(plane.normal(), owner->way);
  if (dt > 0.0) wake.look_below(budget, [&](std::size_t q) { look(q, arrays, true); });
}

// Results of a contact in a step; a contact that is over stays as it is.
PlaneField::Pushed PlaneField::push(PlaneContact &contact, std::size_t q, const ContactArrays &arrays, double dt) const
{
  const Vec3 downward = -1.0 * plane.normal();    // gradient of the depth
  const Vec3 x = near.place(q, arrays.place());
  const double depth = plane.depth(x);
  if (depth <= 0.0) return {{}, depth, 0.0, 0.0, 0.0};
  const double area = owner->body->points()[near.point(q)].area;
  ContactForce<double> force = contact_pressure(law, area, 1.0, depth, dt, contact.memory);
  if (law.friction > 0.0) {
    Vec3 away = x - contact.anchor;
    away -= dot(away, downward) * downward;
    contact_friction(law, area, 1.0, away, downward, dt, contact.memory, force);
    contact.anchor = x - force.kept * away;
  }
  return {-force.press * downward + force.pull + force.drag, depth, force.surface_energy, force.heat, force.damped};
}

void PlaneField::work_ahead(const ContactArrays &arrays, double dt)
{
  for (std::size_t c = 0; c < contacts.size(); ++c) ahead.push_back(push(contacts[c], of_contact[c], arrays, dt));
}

void PlaneField::add_forces(ContactArrays &arrays, double dt, ContactAccount &account)
{
  const bool moves = dt > 0.0, is_known = !ahead.empty();
  std::size_t left = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    PlaneContact contact = contacts[c];
    const std::size_t q = of_contact[c];
    const Pushed pushed = is_known ? ahead[c] : push(contact, q, arrays, dt);
    if (pushed.depth <= 0.0) {
      if (!moves) continue;
      account.heat += contact.memory.stick_energy;
      account.damped += last_damping_work(contact.memory, pushed.depth);
      was_below[q] = 0;
      wake.set(q, budget - pushed.depth);
      continue;
    }
    near.add_force(q, pushed.on_point, arrays.force());
    on_plane -= pushed.on_point;
    account.energy += pushed.energy;
    account.stick_energy += contact.memory.stick_energy;
    account.heat += pushed.heat;
    account.damped += pushed.damped;
    account.deepest = std::max(account.deepest, pushed.depth);
    ++account.touching;
    if (!moves) continue;
    contacts[left] = contact, of_contact[left] = of_contact[c];
    ++left;
  }
  if (moves) contacts.resize(left), of_contact.resize(left);
}

std::size_t PlaneField::bytes() const
{
  return near.bytes() + wake.bytes() + was_below.capacity() + contacts.capacity() * sizeof(PlaneContact) +
         ahead.capacity() * sizeof(Pushed) + of_contact.capacity() * sizeof(std::size_t);
}

}    // namespace mdanim
