// SPDX-License-Identifier: GPL-2.0-only
// The work of contacts in a step, and what begins and ends with them.

#include "contact/object_field.h"

#include "contact/material_map.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

// Cost of a point that is looked at now and then, and of a contact.
int ObjectField::cost() const
{
  constexpr std::size_t POINT = 5, CONTACT = 150;
  return static_cast<int>(POINT * near.size() + CONTACT * contacts.size());
}

// --- contacts ---

// The number of lanes of a block of contacts from number c on.
static int lanes_of(std::size_t c, std::size_t end) { return static_cast<int>(std::min<std::size_t>(CONTACT_LANES, end - c)); }

PushTask ObjectField::task(PointKind kind, const ContactArrays &arrays, double dt) const
{
  const ContactBody &body = *host->body;
  const double longest = std::max({body.count(0) * body.edge(0), body.count(1) * body.edge(1), body.count(2) * body.edge(2)});
  return {law,
          dt,
          body.lattice(),
          host->host_slots().data(),
          arrays.place(),
          2.0 * body.spacing() + longest,
          ramps_of(body, kind),
          is_smooth(body, kind),
          body.frame() ? &*body.frame() : nullptr,
          &host->rigid,
          host->takes_force,
          owner->body->radius()};
}

PointNow ObjectField::point_now(std::size_t q, const ContactArrays &arrays) const
{ return {owner->place_of(near[q], arrays.place()), owner->shift_of(near[q], arrays.place()), owner->areas()[near[q]]}; }

bool ObjectField::find_facing(std::size_t q, const Moment &at, Facing &facing) const
{
  const SurfacePoint &point = surface_point(q);
  const ContactBody &body = *owner->body;
  facing.cell = body.spacing();
  facing.all = owner->faces_all(near[q]);
  if (facing.all) return true;    // no side of its points is the outer one
  Spot<double> spot;
  if (!body.frame()) {
    const std::array<int, 3> cell = {point.cell[0], point.cell[1], point.cell[2]};
    const Placed own = {body, owner->slot.data(), at.place};
    if (!evaluate(own, trilinear({cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5}, cell, body), spot)) return false;
    facing.cell *= body.pressed(spot);
  }
  const Vec3 normal = (body.frame() ? owner->rigid_at(at) : spot).gradient(body.facings()[near[q]].by_cells);
  const double length = std::sqrt(dot(normal, normal));
  if (!(length > 0.0)) return false;
  facing.normal = (1.0 / length) * normal;
  return true;
}

void ObjectField::begin_contact(std::size_t q, const Verdict &verdict, const Vec3 &X, const std::array<int, 3> &cell,
                                std::uint8_t was_open)
{
  FieldContact contact{};
  contact.point = near[q];
  contact.side = verdict.side;
  for (int d = 0; d < 3; ++d) contact.cell[d] = cell[d];
  contact.state.X = contact.state.anchor = X;
  contact.state.memory.depth = verdict.depth;
  contact.state.memory.offset = verdict.is_crushed || was_open >> verdict.side & 1 ? verdict.depth : 0.0;
  begin(q, contact);
}

void ObjectField::push_point(const FieldContact &contact, std::size_t q, const PushedContact<double> &found, bool on_ramp,
                             ContactArrays &arrays) const
{
  owner->push_point(near[q], contact.last.force, arrays.force());
  if (on_ramp) owner->push_centre(near[q], found.at_centre, arrays.force());
}

void ObjectField::count(const FieldContact &contact, const PushedContact<double> &found, ContactAccount &account)
{
  account.energy += contact.last.energy;
  account.stick_energy += contact.state.memory.stick_energy;
  account.heat += found.heat;
  account.damped += found.damped;
  account.work += found.work;
  account.deepest = std::max(account.deepest, contact.state.memory.depth);
  ++account.touching;
}

// Ends contacts of points that are replaced.
void ObjectField::owner_tears(const TornBody *before, const ContactArrays &, ContactAccount &account)
{
  const auto moved = [&](const FieldContact &one) {
    if (!owner->has_changed(one.point, before)) return false;
    account.heat += one.state.memory.stick_energy;
    account.let_go += one.last.energy - 0.5 * dot(one.last.force, one.last.moved);
    return true;
  };
  contacts.erase(std::remove_if(contacts.begin(), contacts.end(), moved), contacts.end());
}

// Turns a contact that is over into a point to be looked at.
void ObjectField::end(const FieldContact &contact, std::size_t q, Fate fate, const ContactArrays &arrays, ContactAccount &account)
{
  account.heat += contact.state.memory.stick_energy;
  // The last force still did work in half of the last step, as leap-frog counts it.
  if (fate == Fate::LOST) account.let_go += contact.last.energy - 0.5 * dot(contact.last.force, contact.last.moved);
  if (fate != Fate::OUT) {
    known[q] = {};
  } else {
    known[q].cell = {contact.cell[0], contact.cell[1], contact.cell[2]};
    known[q].X = contact.state.X;
    known[q].certain = AT_ONCE;
  }
  look_at(q, arrays, false);
}

void ObjectField::begin_step(const ContactArrays &arrays)
{
  known_ahead = 0;
  now.resize(contacts.size());
  if (arrays.kernels)
    arrays.kernels->find_points(owner->points_at(arrays.place()), contacts.data(), static_cast<int>(contacts.size()), now.data());
  else
    for (std::size_t c = 0; c < contacts.size(); ++c) now[c] = point_now(of_contact[c], arrays);
}

// Calls run(first, end, task) for contacts from `first` to `end` - 1, all of points of one kind, from the first kind to the last.
template <class Do> void ObjectField::each_run(double dt, const ContactArrays &arrays, const Do &run) const
{
  for (std::size_t first = 0, end = 0; first < contacts.size(); first = end) {
    const PointKind kind = surface_point(of_contact[first]).kind;
    while (end < contacts.size() && surface_point(of_contact[end]).kind == kind) ++end;
    run(first, end, task(kind, arrays, dt));
  }
}

void ObjectField::work_ahead(const ContactArrays &arrays, double dt)
{
  if (!arrays.kernels) return;
  each_run(dt, arrays, [&](std::size_t first, std::size_t end, const PushTask &task) {
    for (std::size_t c = first; c < end; c += CONTACT_LANES) {
      if (known_ahead == ahead.size()) ahead.emplace_back();
      arrays.kernels->push(task, &contacts[c], &now[c], lanes_of(c, end), ahead[known_ahead++]);
    }
  });
}

void ObjectField::add_forces(ContactArrays &arrays, double dt, ContactAccount &account)
{
  const bool moves = dt > 0.0;
  std::size_t left = 0, block = 0;
  each_run(dt, arrays, [&](std::size_t first, std::size_t end, const PushTask &task) {
    if (moves)
      push_run(first, end, left, block, task, arrays, account);
    else
      for (std::size_t c = first; c < end; ++c) {    // a block that has been computed stays as it is
        FieldContact copy = contacts[c];
        copy.state.change = {};
        push(copy, of_contact[c], task, now[c], arrays, account);
      }
  });
  if (moves) keep_first(left);
  account.looks += looks;
  looks = 0;
}

// Moves the contacts, among those from `first` to `end` - 1, that continue to the places from `left` on; `block` counts those
// that were computed ahead. All forces of a block are added at once where that does not change the order of sums.
void ObjectField::push_run(std::size_t first, std::size_t end, std::size_t &left, std::size_t &block, const PushTask &task,
                           ContactArrays &arrays, ContactAccount &account)
{
  static thread_local PushedBlock scratch;    // clearing it takes longer than a contact
  const PushedBlock *pushed = &scratch;
  const PointsTask points = owner->points_at(arrays.place());
  const auto add = [&](std::size_t of_block, int from, int to) {
    arrays.kernels->add_to_nodes(*pushed, from, to, arrays.force());
    arrays.kernels->add_to_points(points, &contacts[of_block], *pushed, from, to, arrays.force());
  };
  for (std::size_t c = first; c < end; ++c) {
    const std::size_t lane = (c - first) % CONTACT_LANES;
    if (lane == 0 && arrays.kernels) {
      if (known_ahead == 0)
        arrays.kernels->push(task, &contacts[c], &now[c], lanes_of(c, end), scratch);
      else
        pushed = &ahead[block++];
      if (!pushed->hard) add(c, 0, lanes_of(c, end));
    }
    Fate fate = Fate::STAYS;
    if (!arrays.kernels || pushed->hard >> lane & 1) {
      fate = push(contacts[c], of_contact[c], task, now[c], arrays, account);
    } else {
      const int n = static_cast<int>(lane);
      if (pushed->hard) add(c - lane, n, n + 1);
      count(contacts[c], pushed->contact[n], account);
    }
    if (fate != Fate::STAYS) {
      this->end(contacts[c], of_contact[c], fate, arrays, account);
      continue;
    }
    keep(c, left);
  }
}

}    // namespace mdanim
