// SPDX-License-Identifier: GPL-2.0-only
// Contacts of points with a plane.

#include "contact/plane_field.h"

#include <algorithm>

namespace mdanim {

void PlaneField::list(const FieldLists &with)
{
  owner = host = &with.owner;
  const double reach = REACH * with.skin + plane.ahead(with.skin);
  list_points(with, plane.within(reach + owner->body->radius()), true, reach, AT_ONCE,
              [this](const Vec3 &x) { return -depth_at(x); });
}

bool PlaneField::look_at(std::size_t q, const ContactArrays &arrays, bool may_begin)
{
  const Vec3 x = owner->place_of(near[q], arrays.place());
  const double depth = depth_at(x);
  const bool was_below = known[q];
  known[q] = depth > 0.0;
  if (depth <= 0.0 || !may_begin) {
    wake.set(q, budget - std::min(depth, 0.0));
    return false;
  }
  PlaneContact contact{};
  contact.point = near[q];
  contact.plane = number;
  contact.anchor = x - plane.shift;
  contact.memory.depth = depth;
  contact.memory.offset = was_below ? depth : 0.0;
  begin(q, contact);
  return true;
}

// Ends contacts of points that are replaced.
void PlaneField::owner_tears(const TornBody *before, const ContactArrays &arrays, ContactAccount &account)
{
  const auto ends = [&](PlaneContact &one) {
    if (!owner->has_changed(one.point, before)) return false;
    const PointCarriers by = before ? before->carriers_of(one.point) : owner->body->carriers_of(one.point);
    const double area = before ? before->areas()[one.point] : owner->body->areas()[one.point];
    const Vec3 moved = owner->place_by(by, arrays.place()) - owner->place_by(by, arrays.place_before());
    const ContactForce<double> last = contact_pressure(law, area, 1.0, one.memory.depth, 0.0, one.memory);
    // Its last forces still did work in half of this step, as leap-frog counts it.
    const double deeper = -dot(plane.normal(), moved);
    account.heat += one.memory.stick_energy - 0.5 * dot(one.memory.pull + one.memory.drag, moved);
    account.damped += last_damping_work(one.memory, one.memory.depth + deeper);
    account.let_go += last.surface_energy + 0.5 * last.press * deeper;
    return true;
  };
  contacts.erase(std::remove_if(contacts.begin(), contacts.end(), ends), contacts.end());
}

int PlaneField::cost() const
{
  constexpr std::size_t CONTACT = 30;
  return static_cast<int>(near.size() + CONTACT * contacts.size());
}

void PlaneField::begin_step(const ContactArrays &)
{
  on_plane = {};
  ahead.clear();
}

// Results of a contact in a step; a contact that is over stays as it is.
PlaneField::OnPoint PlaneField::push(PlaneContact &contact, std::size_t q, const ContactArrays &arrays, double dt) const
{
  const Vec3 downward = -1.0 * plane.normal();    // gradient of the depth
  const Vec3 x = owner->place_of(near[q], arrays.place());
  const double depth = depth_at(x);
  if (depth <= 0.0) return {{}, depth, 0.0, 0.0, 0.0};
  const double area = owner->areas()[near[q]];
  ContactForce<double> force = contact_pressure(law, area, 1.0, depth, dt, contact.memory);
  if (law.friction > 0.0) {
    const Vec3 there = x - plane.shift;    // anchors go with the plane
    Vec3 away = there - contact.anchor;
    away -= dot(away, downward) * downward;
    contact_friction(law, area, 1.0, away, downward, dt, contact.memory, force);
    contact.anchor = there - force.kept * away;
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
    const OnPoint found = is_known ? ahead[c] : push(contact, q, arrays, dt);
    if (found.depth <= 0.0) {
      if (!moves) continue;
      account.heat += contact.memory.stick_energy;
      account.damped += last_damping_work(contact.memory, found.depth);
      known[q] = 0;
      wake.set(q, budget - found.depth);
      continue;
    }
    owner->push_point(near[q], found.force, arrays.force());
    on_plane -= found.force;
    account.energy += found.energy;
    account.stick_energy += contact.memory.stick_energy;
    account.heat += found.heat;
    account.damped += found.damped;
    account.deepest = std::max(account.deepest, found.depth);
    ++account.touching;
    if (!moves) continue;
    contacts[c] = contact;
    keep(c, left);
  }
  if (moves) keep_first(left);
  if (!plane.moves) return;
  // -F dx with the mean of the forces before and after the step; at the setup of a run nothing has moved.
  if (moves) account.work -= 0.5 * dot(kept_force() + on_plane, plane.of_step);
  if (moves || !before) before = on_plane;
}

}    // namespace mdanim
