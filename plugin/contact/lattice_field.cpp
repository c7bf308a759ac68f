// SPDX-License-Identifier: GPL-2.0-only
// Lists of points that may touch a host that deforms, and the work of a contact with it in a step.

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
  if (!host.is_cuboid()) return STRETCHED * host.overhang() + owner.radius();
  return 0.6 * (host.spacing() + (owner.is_cuboid() ? owner.spacing() : 0.0)) + owner.radius();
}

void LatticeField::list(const FieldLists &with)
{
  owner = &with.owner, host = &with.host;
  const ContactBody &body = *host->body;
  if (body.is_line()) return;    // no point is in it
  const double out = host->is_crushed ? NEAREST * body.spacing() + owner->body->radius() : stands_out(*owner->body, body);
  Zone zone = with.host_zone->grown(out);
  const double beyond = body.is_cuboid() || host->is_crushed ? out : BETWEEN_POINTS * body.spacing() + owner->body->radius();
  zone.from = with.of_host.least_along(zone.across) - beyond;
  list_points(with, zone.grown(with.skin), body.is_cuboid(), with.skin, TRUSTED * body.spacing(),
              [&zone](const Vec3 &x) { return zone.outside(x); });
}

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
  below.value += task.radius;
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
    if (task.dt > 0.0) {
      account.damped += last_damping_work(contact.state.memory, below.value);
      if (below.value > task.longest)    // it has been pulled through
        account.let_go += let_go_energy(task.law, now.area, contact.state.memory, contact.last.energy,
                                        below.value - contact.state.memory.depth, part);
    }
    return Fate::OUT;
  }

  Vec3 turn;
  if (task.is_smooth && is_on_ramp(part_slope)) turn = part_turn(weights.axis, place, spot, part_slope, shift);
  const ContactPush<double> push =
      contact_push(task.law, task.dt, now.area, part, part_slope, turn, below, flat, spot, off, shift, contact.state);
  contact.last = push.outcome;

  spread(at, weights, -1.0 * push.both, {-1.0 * push.moment[0], -1.0 * push.moment[1], -1.0 * push.moment[2]}, arrays.force());
  const PushedContact<double> found = {push.at_centre, push.heat, push.damped, push.work};
  push_point(contact, q, found, is_on_ramp(part_slope), arrays);
  count(contact, found, account);
  return Fate::STAYS;
}

}    // namespace mdanim
