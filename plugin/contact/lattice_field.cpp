// SPDX-License-Identifier: GPL-2.0-only
// Lists of points that may touch, and the work of contacts in a step.

#include "contact/lattice_field.h"

#include "contact/contact_birth.h"
#include "contact/contact_follow.h"

#include <algorithm>

namespace mdanim {

static constexpr double TRUSTED = 1.0;           // cells to go, with which the last look at a point is still trusted in new lists
static constexpr double BETWEEN_POINTS = 0.6;    // spacings by which a round surface may extend beyond its points

// --- lists ---

// A point counts until the centre of its area is a quarter of a cell beyond an edge. The drawn surface of a shape that is not a
// cuboid extends beyond its particles, and farther where cells are stretched.
double LatticeField::stands_out(const ContactBody &owner, const ContactBody &host)
{
  if (!host.is_cuboid()) return STRETCHED * host.overhang();
  return 0.6 * (host.spacing() + (owner.is_cuboid() ? owner.spacing() : 0.0));
}

void LatticeField::list(const FieldLists &with)
{
  owner = &with.owner, host = &with.host;
  const ContactBody &body = *host->body;
  const double out = stands_out(*owner->body, body);
  Zone zone = with.host_zone->grown(out);
  zone.from = with.of_host.least_along(zone.across) - (body.is_cuboid() ? out : BETWEEN_POINTS * body.spacing());
  list_points(with, zone.grown(with.skin), body.is_cuboid(), with.skin, TRUSTED * body.spacing(),
              [&zone](const Vec3 &x) { return zone.outside(x); });
}

// Cost of a point that is looked at now and then, and of a contact.
int LatticeField::cost() const
{
  constexpr std::size_t POINT = 5, CONTACT = 150;
  return static_cast<int>(POINT * near.size() + CONTACT * contacts.size());
}

// --- contacts ---

// The number of lanes of a block of contacts from number c on.
static int lanes_of(std::size_t c, std::size_t end) { return static_cast<int>(std::min<std::size_t>(CONTACT_LANES, end - c)); }

PushTask LatticeField::task(PointKind kind, const ContactArrays &arrays, double dt) const
{
  const ContactBody &body = *host->body;
  const double longest = std::max({body.count(0) * body.edge(0), body.count(1) * body.edge(1), body.count(2) * body.edge(2)});
  return {law,
          dt,
          body.lattice(),
          host->slot.data(),
          arrays.place(),
          2.0 * body.spacing() + longest,
          ramps_of(body, kind),
          is_smooth(body, kind)};
}

PointNow LatticeField::point_now(std::size_t q, const ContactArrays &arrays) const
{ return {near.place(q, arrays.place()), near.shift(q, arrays.place()), surface_point(q).area}; }

LatticeField::Fate LatticeField::push(FieldContact &contact, std::size_t q, const PushTask &task, const PointNow &now,
                                      ContactArrays &arrays, ContactAccount &account) const
{
  const Placed at = {*host->body, task.slot, task.place};
  MapWeights weights;
  Spot<double> spot;
  Vec3 off, part_slope;
  if (!follow(contact, task, *host->body, now.x, weights, spot, off)) return Fate::LOST;
  const Vec3 shift = spot.to_material(now.shift);
  Depth<double> below = host->body->depth(contact.side, contact.state.X);
  const auto place = [&](int i, int j, int k) {
    return at.place[at.slot[weights.base + i + at.body.row() * j + at.body.layer() * k]].value;
  };
  const Vec3 normal = spot.gradient(below.slope);
  FlattenedDepth<double> flat;
  if (task.is_smooth && is_flattened(normal)) {
    flat = flattened_depth(weights.axis, place, spot, normal, below.value);
    below.value = flat.part * below.value;
  }
  double part = 1.0;
  if (host->body->is_cuboid())
    part = part_that_counts<double>(task.ramps, task.host, contact.state.X + shift, contact.side / 2, part_slope);
  if (task.is_smooth && is_crushed(spot, at.body)) {
    if (task.dt > 0.0) {
      account.let_go += let_go_energy(task.law, now.area, contact.state.memory, contact.last.energy,
                                      below.value - contact.state.memory.depth, part);
      account.damped += last_damping_work(contact.state.memory, below.value);
    }
    return Fate::CRUSHED;
  }
  if (!(below.value > std::min(contact.state.memory.offset, 0.0) && part > 0.0 && below.value <= task.longest)) {
    if (task.dt > 0.0) account.damped += last_damping_work(contact.state.memory, below.value);
    return Fate::OUT;
  }

  Vec3 turn;
  if (task.is_smooth && is_on_ramp(part_slope)) turn = part_turn(weights.axis, place, spot, part_slope, shift);
  const ContactPush<double> push =
      contact_push(task.law, task.dt, now.area, part, part_slope, turn, below, flat, spot, off, shift, contact.state);
  contact.last = push.outcome;

  PaddedVec3 *on = arrays.force();
  near.add_force(q, push.outcome.force, on);
  if (is_on_ramp(part_slope)) near.add_force_at_centre(q, push.at_centre, on);
  spread(at, weights, -1.0 * push.both, {-1.0 * push.moment[0], -1.0 * push.moment[1], -1.0 * push.moment[2]}, on);
  count(contact, push.heat, push.damped, account);
  return Fate::STAYS;
}

// Does the work of push() with results of the kernel. All forces of a block are added at once where that does not change the
// order of sums.
void LatticeField::take(const FieldContact &contact, std::size_t q, const PushedBlock &pushed, int lane, ContactArrays &arrays,
                        ContactAccount &account) const
{
  const PushedContact<double> &found = pushed.contact[lane];
  if (pushed.hard) arrays.kernels->add_to_nodes(pushed, lane, lane + 1, arrays.force());
  near.add_force(q, contact.last.force, arrays.force());
  if (pushed.on_ramp >> lane & 1) near.add_force_at_centre(q, found.at_centre, arrays.force());
  count(contact, found.heat, found.damped, account);
}

void LatticeField::count(const FieldContact &contact, double heat, double damped, ContactAccount &account) const
{
  account.energy += contact.last.energy;
  account.stick_energy += contact.state.memory.stick_energy;
  account.heat += heat;
  account.damped += damped;
  account.deepest = std::max(account.deepest, contact.state.memory.depth);
  ++account.touching;
}

// Turns a contact that is over into a point to be looked at.
void LatticeField::end(const FieldContact &contact, std::size_t q, Fate fate, const ContactArrays &arrays,
                       ContactAccount &account)
{
  account.heat += contact.state.memory.stick_energy;
  // The last force still did work in half of the last step, as leap-frog counts it.
  if (fate == Fate::LOST) account.let_go += contact.last.energy - 0.5 * dot(contact.last.force, contact.last.moved);
  if (fate != Fate::OUT) {
    known[q] = {};
  } else {
    known[q].cell = {contact.cell[0], contact.cell[1], contact.cell[2]};
    known[q].X = contact.state.X;
  }
  look_at(q, arrays, false);
}

void LatticeField::begin_step(const ContactArrays &arrays)
{
  now.clear();
  for (const std::size_t q : of_contact) now.push_back(point_now(q, arrays));
  known_ahead = 0;
}

// Calls run(first, end, task) for contacts from `first` to `end` - 1, all of points of one kind, from the first kind to the last.
template <class Do> void LatticeField::each_run(double dt, const ContactArrays &arrays, const Do &run) const
{
  for (std::size_t first = 0, end = 0; first < contacts.size(); first = end) {
    const PointKind kind = surface_point(of_contact[first]).kind;
    while (end < contacts.size() && surface_point(of_contact[end]).kind == kind) ++end;
    run(first, end, task(kind, arrays, dt));
  }
}

void LatticeField::work_ahead(const ContactArrays &arrays, double dt)
{
  if (!arrays.kernels) return;
  each_run(dt, arrays, [&](std::size_t first, std::size_t end, const PushTask &task) {
    for (std::size_t c = first; c < end; c += CONTACT_LANES) {
      if (known_ahead == ahead.size()) ahead.emplace_back();
      arrays.kernels->push(task, &contacts[c], &now[c], lanes_of(c, end), ahead[known_ahead++]);
    }
  });
}

void LatticeField::add_forces(ContactArrays &arrays, double dt, ContactAccount &account)
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
// that were computed ahead.
void LatticeField::push_run(std::size_t first, std::size_t end, std::size_t &left, std::size_t &block, const PushTask &task,
                            ContactArrays &arrays, ContactAccount &account)
{
  PushedBlock scratch;
  const PushedBlock *pushed = &scratch;
  for (std::size_t c = first; c < end; ++c) {
    const std::size_t lane = (c - first) % CONTACT_LANES;
    if (lane == 0 && arrays.kernels) {
      if (known_ahead == 0)
        arrays.kernels->push(task, &contacts[c], &now[c], lanes_of(c, end), scratch);
      else
        pushed = &ahead[block++];
      if (!pushed->hard) arrays.kernels->add_to_nodes(*pushed, 0, lanes_of(c, end), arrays.force());
    }
    Fate fate = Fate::STAYS;
    if (!arrays.kernels || pushed->hard >> lane & 1)
      fate = push(contacts[c], of_contact[c], task, now[c], arrays, account);
    else
      take(contacts[c], of_contact[c], *pushed, static_cast<int>(lane), arrays, account);
    if (fate != Fate::STAYS) {
      this->end(contacts[c], of_contact[c], fate, arrays, account);
      continue;
    }
    keep(c, left);
  }
}

}    // namespace mdanim
