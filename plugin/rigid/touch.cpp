// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/touch.h"

#include <cmath>

namespace mdanim {

// The dashpot has beta times critical damping, 2 beta sqrt(k/lambda), with lambda of both along n.
Touch TouchStep::born(Touch::TouchKind kind, const TouchLaw &law, double yields)
{
  Touch touch;
  touch.kind = kind;
  touch.stiffness = law.stiffness;
  touch.yields = yields;
  touch.damping = law.damping > 0.0 ? 2.0 * law.damping * std::sqrt(law.stiffness / touch.yields) / law.stiffness : 0.0;
  return touch;
}

Vec3 TouchStep::relative_velocity(const Solid &a, const Solid *b, const Vec3 &x)
{
  const Vec3 v = a.velocity_at(x);
  return b ? v - b->velocity_at(x) : v;
}

void TouchStep::end(Touch &touch, double depth) const
{
  account.heat += touch.memory.stick_energy;
  account.damped += last_damping_work(touch.memory, std::min(depth, touch.memory.depth));
}

void TouchStep::let_go(Touch &touch, double depth, double part) const
{
  account.let_go += touch.stiffness * part * Onset<double>(depth - touch.memory.offset, onset).value;
  end(touch, depth);
}

// Energy over the way from depth a to b, less the mean of the forces at both ends: 0 where the spring is linear.
static double more_force(double a, double b, double onset)
{
  constexpr double SMALL = 1e-4;    // way over the onset on which both are the same
  if (std::fabs(b - a) < SMALL * onset || std::min(a, b) >= onset) return 0.0;
  const Onset<double> at_a(a, onset), at_b(b, onset);
  return (at_b.value - at_a.value) / (b - a) - 0.5 * (at_a.slope + at_b.slope);
}

// A force acts over the mean of the ways before and after it: the way over that mean, where the other one goes on in the same
// sense.
static double share_of(double way, double other) { return 2.0 * way / (way + std::max(other, 0.0)); }

// The force F of a step does the work F (d' - d_)/2, d_ and d' being the depths of the step before and of the next one. Summed
// over steps this is the mean of the forces at both ends of each way, times the way: too much where a contact begins or ends, and
// in its onset. The deeper end of a way has the force that is missing or too much. d' is where speed and force lead to.
ContactForce<double> TouchStep::pressure(Touch &touch, const ContactLaw &law, double part, double depth) const
{
  const double before = touch.memory.depth;
  ContactForce<double> force = contact_pressure<double>(law, 1.0, part, depth, dt, touch.memory);
  if (is_first()) return force;
  const double now = depth - touch.memory.offset, last = before - touch.memory.offset,
               next = 2.0 * now - last - dt * dt * touch.yields * force.press;
  const double k = touch.stiffness * part, came = now - last, goes = now - next;
  if (came > 0.0) force.press += k * share_of(came, -goes) * more_force(last, now, onset);
  if (goes > 0.0) force.press += k * share_of(goes, -came) * more_force(now, next, onset);
  if (force.press < 0.0) {    // a dashpot never pulls
    touch.memory.damping -= force.press;
    force.damped -= 0.5 * force.press * (depth - before);
    force.press = 0.0;
  }
  return force;
}

void TouchStep::apply(Solid &a, Solid *b, const Vec3 &x, const Vec3 &f) const
{
  a.force += f;
  a.torque += cross(x - a.centre, f);
  if (!b) return;
  b->force -= f;
  b->torque -= cross(x - b->centre, f);
}

// S = sum of 2 k lambda* over the contacts of a body (k lambda* at planes). The springs of a contact are k (n n + 0.8 t t), so
// lambda* is at most 0.2 lambda + 0.8 lambda along any direction; n of two edges may be any direction. D is the same with
// dashpots, k eta (n n + 0.5 sqrt(0.8) t t).
void TouchStep::book(Solid &a, Solid *b, Touch &touch, double part, const ContactForce<double> &force) const
{
  touch.energy = part * force.surface_energy + touch.memory.stick_energy;
  account.energy += touch.energy;
  account.heat += force.heat;
  account.damped += force.damped;
  ++account.touching;
  account.deepest = std::max(account.deepest, touch.memory.depth - touch.memory.offset);
  const auto add_to_sums = [&](Solid &one) {
    const auto along = [&](double stick) {    // sum of lambda n n and `stick` t t
      return touch.kind == Touch::EDGES || touch.kind == Touch::CURVES ? one.yields_any
                                                                       : (1.0 - stick) * one.yields + stick * one.yields_any;
    };
    const double s = (b ? 2.0 : 1.0) * touch.stiffness;
    one.stiffness_sum += s * along(ContactLaw::STICK);
    one.damping_sum += s * touch.damping * along(STICK_DAMPING * std::sqrt(ContactLaw::STICK));
    ++one.touching;
  };
  add_to_sums(a);
  if (b) add_to_sums(*b);
}

void TouchStep::press(Touch &touch, const TouchLaw &its_law, Solid &a, Solid *b, const Vec3 &own, double depth, double part,
                      const Vec3 &slope, const Vec3 &n) const
{
  const ContactLaw law = law_of(touch, its_law);
  ContactForce<double> push = pressure(touch, law, part, depth);
  Vec3 force = push.press * n;
  if (b && (slope.x != 0.0 || slope.y != 0.0 || slope.z != 0.0)) force -= push.surface_energy * b->in_space(slope);
  if (law.friction > 0.0) {
    const Vec3 from_anchor = own - touch.anchor;
    Vec3 away = b ? b->in_space(from_anchor) : from_anchor;
    away -= dot(away, n) * n;    // the anchor follows along the normal
    friction(touch, law, part, away, n, push);
    const Vec3 left = push.kept * away;
    touch.anchor = own - (b ? b->in_body(left) : left);
    force += push.pull + push.drag;
  }
  apply(a, b, b ? b->place(own) : own, force);
  book(a, b, touch, part, push);
}

Touch *TouchStep::meet(std::vector<Touch> &list, Touch::TouchKind kind, int number, const TouchLaw &law, const Solid &a,
                       const Solid *b, const Vec3 &x, const Vec3 &n, double depth, const Vec3 &anchor) const
{
  const auto found = find_touch(list, kind, number);
  if (depth <= 0.0) {
    if (found == list.end()) return nullptr;
    end(*found, depth);
    list.erase(found);
    return nullptr;
  }
  if (found != list.end()) return &*found;
  Touch touch = born(kind, law, a, b, x, n);
  touch.first = number;
  touch.anchor = anchor;
  if (is_first())
    overlaps(touch, depth);
  else
    came_from(touch, depth + dt * dot(relative_velocity(a, b, x), n));
  list.push_back(touch);
  return &list.back();
}

void TouchStep::begin(Touch &touch, const Solid &a, const Solid *b, const Meeting &at, bool came) const
{
  if (came && !is_first())
    came_from(touch, at.depth + dt * dot(relative_velocity(a, b, at.x), at.n));
  else
    overlaps(touch, at.depth);
}

void TouchStep::press_moving(std::vector<Touch> &list, Touch::TouchKind kind, int number, const TouchLaw &law, Solid &a, Solid *b,
                             const Vec3 &x, const Vec3 &n, double depth) const
{
  if (Touch *const touch = meet(list, kind, number, law, a, b, x, n, depth, {}))
    press_between(*touch, law, a, b, {x, n, depth, 1.0}, nullptr);
}

void TouchStep::press_between(Touch &touch, const TouchLaw &its_law, Solid &a, Solid *b, const Meeting &at,
                              const PartSlope *slope) const
{
  const ContactLaw law = law_of(touch, its_law);
  ContactForce<double> push = pressure(touch, law, at.part, at.depth);
  Vec3 force = push.press * at.n;
  if (slope) {
    force -= push.surface_energy * slope->by_place;
    const Vec3 torque = push.surface_energy * slope->by_turn;
    a.torque -= torque;
    if (b) b->torque += torque;
  }
  if (law.friction > 0.0) {
    // The way that the material of one went over that of the other, step by step.
    Vec3 away = b ? b->in_space(touch.anchor) : touch.anchor;
    away += dt * relative_velocity(a, b, at.x);
    away -= dot(away, at.n) * at.n;
    friction(touch, law, at.part, away, at.n, push);
    const Vec3 left = push.kept * away;
    touch.anchor = b ? b->in_body(left) : left;
    force += push.pull + push.drag;
  }
  apply(a, b, at.x, force);
  book(a, b, touch, at.part, push);
}

}    // namespace mdanim
