// SPDX-License-Identifier: GPL-2.0-only
// Lists of points that may touch a host that does not deform, looks at them, and the work of a contact with it in a step.

#include "contact/rigid_field.h"

#include "contact/lattice_field.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

static constexpr double LOOKED_AT = 0.75;    // cells from where a point may act within which its normal matters
static constexpr double TRUSTED = 1.0;       // as in lattice_field.cpp

// How far X is from where a point may act on the host [m]: beside a cuboid a point acts while the centre of its area is there.
double RigidField::outside(const Vec3 &X) const
{
  const ContactBody &body = *host->body;
  double square = 0.0;
  for (int d = 0; d < 3; ++d) {
    const double at = component(X, d), low = component(body.least(), d), high = component(body.most(), d);
    const double out = body.edge(d) * std::max({low - at, at - high, 0.0});
    square += out * out;
  }
  return std::max(0.0, std::sqrt(square) - LatticeField::stands_out(*owner->body, body));
}

void RigidField::list(const FieldLists &with)
{
  owner = &with.owner, host = &with.host;
  const ContactBody &body = *host->body;
  const double looked_at = LOOKED_AT * body.spacing(), radius = owner->body->radius();
  // A point must be looked at before its normal matters.
  const auto distance = [&](const Vec3 &x) {
    const Vec3 X = to_material(x);
    const double out = outside(X);
    return (out > 0.0 || body.is_cuboid() ? out : -(body.depth(0, X).value + radius)) - looked_at;
  };
  const double reach = LatticeField::stands_out(*owner->body, body) + looked_at + with.skin;
  list_points(with, with.host_zone->grown(reach), body.is_cuboid(), with.skin, TRUSTED * body.spacing(), distance);
}

// The verdict on a point, and its X.
Verdict RigidField::sight(std::size_t q, const Moment &at, Vec3 &X) const
{
  const SurfacePoint &point = surface_point(q);
  const ContactBody &body = *host->body;
  const Spot<double> &frame = host->rigid_at(at);
  const double radius = owner->body->radius();
  Verdict verdict;
  X = frame.to_material(owner->place_of(near[q], at.place) - frame.x);
  verdict.slack = outside(X) - LOOKED_AT * body.spacing();
  if (verdict.slack > 0.0) return verdict;
  const Vec3 X_centre = X + frame.to_material(owner->shift_of(near[q], at.place));
  verdict.slack = slack_of_far(body, point, radius, X, X_centre, frame, 0.0);
  if (verdict.slack > 0.0) return verdict;
  Facing facing;
  if (find_facing(q, at, facing)) return judge(body, point, radius, X, X_centre, frame, facing, 0.0);
  verdict.open = EVERY_SIDE;    // not all of its particles are here
  verdict.slack = 0.0;
  return verdict;
}

bool RigidField::look_at(std::size_t q, const ContactArrays &arrays, bool may_begin)
{
  ++looks;
  Vec3 X, X_before;
  const Verdict verdict = sight(q, arrays.now(), X);
  if (!may_begin || verdict.side < 0) {
    wake.set(q, budget + std::max(0.0, verdict.slack));
    return false;
  }
  begin_contact(q, verdict, X, {0, 0, 0}, sight(q, arrays.before(), X_before).open);
  return true;
}

ObjectField::Fate RigidField::push(FieldContact &contact, std::size_t q, const PushTask &task, const PointNow &now,
                                   ContactArrays &arrays, ContactAccount &account) const
{
  const ContactBody &body = *host->body;
  const Spot<double> &spot = host->rigid;
  const Vec3 X = to_material(now.x), shift = spot.to_material(now.shift);
  contact.state.change = X - contact.state.X;
  contact.state.X = X;
  Depth<double> below = body.depth(contact.side, X);
  below.value += task.radius;
  double part = 1.0;
  Vec3 part_slope;
  if (body.is_cuboid()) part = part_that_counts<double>(task.ramps, task.host, X + shift, contact.side / 2, part_slope);
  if (!(below.value > std::min(contact.state.memory.offset, 0.0) && part > 0.0 && below.value <= task.longest)) {
    if (task.dt > 0.0) {
      account.damped += last_damping_work(contact.state.memory, below.value);
      if (below.value > task.longest)    // it has been pulled through
        account.let_go += let_go_energy(task.law, now.area, contact.state.memory, contact.last.energy,
                                        below.value - contact.state.memory.depth, part);
    }
    return Fate::OUT;
  }
  const ContactPush<double> push =
      contact_push(task.law, task.dt, now.area, part, part_slope, Vec3{}, below, {}, spot, Vec3{}, shift, contact.state);
  contact.last = push.outcome;
  const Vec3 moment[3] = {-1.0 * push.moment[0], -1.0 * push.moment[1], -1.0 * push.moment[2]};
  if (task.takes_force)
    spread_to_frame(*task.frame, X, -1.0 * push.both, moment,
                    [&](int k, const Vec3 &force) { arrays.force()[task.slot[k]].value += force; });
  const PushedContact<double> found = {push.at_centre, push.heat, push.damped, push.work};
  push_point(contact, q, found, is_on_ramp(part_slope), arrays);
  count(contact, found, account);
  return Fate::STAYS;
}

}    // namespace mdanim
