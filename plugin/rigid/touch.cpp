// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/touch.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

namespace {

// Corners of a body that are as high over a surface as the one that begins to touch it, with the surface below them: they press
// with it.
struct LevelCorners {
  int count = 0;
  Vec3 middle;    // of their places
  LevelCorners(const Solid &one, const Solid *host, const Vec3 &x, const Vec3 &n)
  {
    constexpr double LEVEL = 0.02;     // over the thinnest part: how deep the fastest blow goes
    constexpr double BESIDE = 0.05;    // over the size: corners of twins that are turned on each other are beside their ends
    const Vec3 down = one.in_body(n);
    const double height = dot(n, x - one.centre), near = LEVEL * one.shape.thin(), beside = BESIDE * one.shape.bound();
    const bool may_miss = host && host->shape.kind() != SolidShape::MESH;
    Vec3 sum;
    for (const Polyhedron::Corner &corner : one.shape.corners()) {
      if (corner.covered || std::fabs(dot(down, corner.at) - height) > near) continue;
      if (may_miss && host->shape.nearest(host->in_body(one.place(corner.at) - host->centre)).distance > beside) continue;
      sum += corner.at, ++count;
    }
    if (count) middle = one.place((1.0 / count) * sum);
  }
};

// A flat end with many corners is as hard as one with FEW: with a whole spring at each of 36 corners no step was short enough.
// All of them yield together, as their middle; 0 where there are few. Edges of ends that are turned on each other cross at twice
// as many places.
struct SharedContact {
  static constexpr int FEW = 6;
  double share = 1.0, yields = 0.0;
  SharedContact(Touch::TouchKind kind, const Solid &a, const Solid *b, const Vec3 &x, const Vec3 &n)
  {
    const bool is_crossing = kind == Touch::EDGES || kind == Touch::CURVES;
    if (!is_crossing && kind != Touch::CORNER && kind != Touch::CORNER_OF_OTHER) return;
    LevelCorners level(a, b, x, n);    // corners are those of a
    if (is_crossing)
      if (const LevelCorners other(*b, &a, x, n); other.count > level.count) level = other;
    const int count = is_crossing ? 2 * level.count : level.count;
    if (count <= FEW) return;
    share = static_cast<double>(FEW) / count;
    yields = count * (a.yields_at(level.middle, n) + (b ? b->yields_at(level.middle, n) : 0.0));
  }
};

}    // namespace

Touch TouchStep::born(Touch::TouchKind kind, const TouchLaw &law, const Solid &a, const Solid *b, const Vec3 &x,
                      const Vec3 &n) const
{
  constexpr double A_BLOW = 0.04;    // of the speed that goes through the onset: what is slower is laid down
  const SharedContact one(kind, a, b, x, n);
  const double alone = one.share < 1.0 ? one.yields / SharedContact::FEW : a.yields_at(x, n) + (b ? b->yields_at(x, n) : 0.0);
  Touch touch = born(kind, {one.share * law.stiffness, law.friction, law.damping, law.rolling}, alone);
  if (one.share < 1.0) touch.yields = one.yields;
  touch.alone = alone;
  const double speed = -dot(relative_velocity(a, b, x), n);
  touch.shares = !is_first() && touch.damping > 0.0 && speed > A_BLOW * onset * std::sqrt(touch.stiffness * touch.yields);
  changes = true;
  return touch;
}

void TouchStep::listed(std::vector<Touch> &touches, const InBlow &of) const
{ blows.hold(touches, of, std::exchange(changes, false)); }

Vec3 TouchStep::relative_velocity(const Solid &a, const Solid *b, const Vec3 &x)
{
  const Vec3 v = a.velocity_at(x);
  return b ? v - b->velocity_at(x) : v;
}

void TouchStep::end(Touch &touch, double depth) const
{
  changes = true;
  add(account.let_go, -touch.owed);
  add(account.heat, touch.memory.stick_energy + touch.rolling.stick_energy);
  add(account.damped, last_damping_work(touch.memory, std::min(depth, touch.memory.depth)));
}

void TouchStep::let_go(Touch &touch, double depth, double part) const
{
  add(account.let_go, touch.stiffness * part * Onset<double>(depth - touch.memory.offset, onset).value);
  end(touch, depth);
}

// --- the work of contacts ---
//
// Leap-frog takes F_n (d_n+1 - d_n-1)/2 from the motion by the force F of a step, d being the depths: summed over steps this is
// the mean of the forces at both ends of each way, times the way. Of a linear spring it is the energy U. Where a contact begins
// or ends, and in its onset, U changes by something else, and a force `more` beside that of the spring makes up for it,
//   sum more_n (d_n+1 - d_n-1)/2 = sum over ways of E,   E = U(d') - U(d) - (d' - d) (U'(d') + U'(d))/2.
// The deeper end of a way has its E. d_n+1 is where the motion leads to by the force and by all else that acted in the step
// before; what comes otherwise is owed, and given by the next steps, the last part of it in the step after the bodies have
// parted. Bodies do not meet along n by what the depth changes where n turns, with a curved surface or with a body. What
//   F_n (met_n + met_n+1)/2
// takes from the motion, met_n+1 being their way along n_n in the next step, is more than that: it is given back likewise.

// E over the way, for a spring of 1.
static double more_force(double a, double b, double onset)
{
  constexpr double SMALL = 1e-4;    // way over the onset on which both are the same
  if (std::fabs(b - a) < SMALL * onset || std::min(a, b) >= onset) return 0.0;
  const Onset<double> at_a(a, onset), at_b(b, onset);
  return (at_b.value - at_a.value) / (b - a) - 0.5 * (at_a.slope + at_b.slope);
}

// The force that does this work over the ways before and after a step: none where these nearly cancel each other, and at most as
// hard as the spring over both.
static double force_over(double work, double k, double came, double next_way)
{
  constexpr double LEAST = 0.5;
  const double both = std::fabs(came) + std::fabs(next_way), way = came + next_way;
  if (work == 0.0 || std::fabs(way) <= LEAST * both) return 0.0;
  return std::clamp(2.0 * work / way, -0.5 * k * both, 0.5 * k * both);
}

// The way of its bodies towards each other along the last normal, over both steps around it, less the change of depth.
double TouchStep::unlike_depth(const Touch &touch, const Solid &a, const Solid *b, double depth) const
{
  const auto along = [&](const Solid &one) { return dot(touch.n, one.velocity_from(touch.at, dt)); };
  const double apart = b ? along(a) - along(*b) : along(a);    // along n, which pushes the body with the lower number
  const double meets = (b && b->id < a.id ? dt : -dt) * apart, last = touch.memory.depth;
  const double before = touch.followed > 1.0 ? touch.met - (last - touch.earlier) : 0.0;    // it may have come from beside
  return before + meets - (depth - last);
}

// Books the work of the last step's force, now that its way is known. Returns the change of depth by all other forces.
double TouchStep::follow(Touch &touch, const Solid &a, const Solid *b, double depth, double k) const
{
  if (touch.followed == 0.0) return 0.0;
  const double last = touch.memory.depth, offset = touch.memory.offset;
  if (depth < last) touch.owed += k * (depth - last) * more_force(last - offset, depth - offset, onset);
  touch.owed -= 0.5 * (touch.more * (depth - touch.earlier) + touch.press * unlike_depth(touch, a, b, depth));
  return (depth - last) - (last - touch.earlier) + dt * dt * touch.yields * touch.press;
}

// The depth at which a contact has no force falls to a part 1/e in the time in which its frequency goes through OUT radians, so
// that bodies are moved and not thrown, where what it bears is within the onset. The energy that it gains so is booked.
void TouchStep::press_out(Touch &touch, double depth, double k) const
{
  constexpr double OUT = 1000.0;
  if (depth_of(touch) >= onset) return;
  const double less = (dt / OUT) * std::sqrt(touch.stiffness * touch.yields) * touch.memory.offset;
  const auto gains = [&](double within) {
    return Onset<double>(within + less, onset).value - Onset<double>(within, onset).value;
  };
  add(account.let_go, -0.5 * k * (gains(depth_of(touch)) + gains(depth - touch.memory.offset)));    // of both ends of the way
  touch.memory.offset -= less;
}

// The dashpot over that of a spring without an onset: in a blow F/sqrt(2 k U) for the force F of the spring and its energy U. As
// a function of sqrt(2 U) the speed then is that of a linear spring, whatever F, so that as much is left of a slow blow, which
// hardly leaves the onset, as of a fast one. What has gone deeper again after it came back rests: that has all of it, and
// trembles less.
static double dashpot_at(const Touch &touch, double depth, double onset)
{
  if (touch.rests != 0.0) return 1.0;
  const Onset<double> g(depth - touch.memory.offset, onset);
  return g.value > 0.0 ? touch.shared * g.slope / std::sqrt(2.0 * g.value) : 0.0;
}

ContactForce<double> TouchStep::pressure(Touch &touch, const Solid &a, const Solid *b, const ContactLaw &its_law, double part,
                                         double depth) const
{
  constexpr int LOOKS = 3;    // each is nearer to the next depth by (dt Omega)^2 and more
  const double k = touch.stiffness * part;
  if (presses_out && touch.followed != 0.0) press_out(touch, depth, k);
  const double before = touch.memory.depth, pulled = is_first() ? 0.0 : follow(touch, a, b, depth, k);
  if (touch.followed != 0.0 && before < touch.earlier && depth > before) touch.rests = 1.0;
  ContactLaw law = its_law;
  law.damping *= dashpot_at(touch, depth, onset);
  ContactForce<double> force = contact_pressure<double>(law, 1.0, part, depth, dt, touch.memory);
  if (is_first()) return force;
  const double now = depth - touch.memory.offset, came = depth - before;
  if (came > 0.0) touch.owed += k * came * more_force(now - came, now, onset);
  touch.more = 0.0;
  for (int look = 0; look < LOOKS; ++look) {
    const double way = came + pulled - dt * dt * touch.yields * (force.press + touch.more);
    const double goes = way < 0.0 ? k * way * more_force(now, now + way, onset) : 0.0;
    const double more = std::max(force_over(touch.owed + goes, k, came, way), -force.press);    // a contact never pulls
    if (more == touch.more) break;
    touch.more = more;
  }
  force.press += touch.more;
  touch.press = force.press;
  touch.earlier = before;
  touch.followed = touch.followed == 0.0 ? 1.0 : 2.0;
  return force;
}

void TouchStep::part(Touch &touch, Solid &a, Solid *b, const Meeting &at) const
{
  const double before = touch.memory.depth, depth = std::min(at.depth, before), came = depth - before;
  const double way = came + follow(touch, a, b, depth, touch.stiffness * at.part);
  touch.parted = 1.0;
  touch.energy = 0.0;
  if (depth <= 0.0) {
    touch.more = force_over(touch.owed, touch.stiffness, came, way);
    apply(a, b, at.x, touch.more * at.n);
    touch.energy = -0.5 * touch.more * way;    // for half of the last way
    touch.owed -= 0.5 * touch.more * (came + way);
  }
  end(touch, depth);
}

void TouchStep::apply(Solid &a, Solid *b, const Vec3 &x, const Vec3 &f) const
{ push({&a, b, f, cross(x - a.centre, f), b ? cross(x - b->centre, f) : Vec3()}); }

// S = sum of 2 k lambda* over the contacts of a body (k lambda* at planes). The springs of a contact are k (n n + 0.8 t t), so
// lambda* is at most 0.2 lambda + 0.8 lambda along any direction; n of two edges may be any direction. D is the same with
// dashpots, k eta (n n + 0.5 sqrt(0.8) t t).
void TouchStep::book(Solid &a, Solid *b, Touch &touch, const Meeting &at, const ContactForce<double> &force) const
{
  touch.at = at.x;
  if (!is_first()) touch.met = -dt * dot(at.n, relative_velocity(a, b, at.x));
  touch.part = at.part;
  touch.n = b && b->id < a.id ? -1.0 * at.n : at.n;
  // `more` has done a half of its work.
  touch.energy = at.part * force.surface_energy + touch.memory.stick_energy + touch.rolling.stick_energy - touch.owed +
                 0.5 * touch.more * (touch.memory.depth - touch.earlier);
  add(account.heat, force.heat);
  add(account.damped, force.damped);
  if (late)
    late->deepen(depth_of(touch));
  else
    account.deepest = std::max(account.deepest, depth_of(touch));
  const auto add_to_sums = [&](Solid &one) {
    const auto along = [&](double stick) {    // sum of lambda n n and `stick` t t
      return touch.kind == Touch::EDGES || touch.kind == Touch::CURVES ? one.yields_any
                                                                       : (1.0 - stick) * one.yields + stick * one.yields_any;
    };
    const double s = (b ? 2.0 : 1.0) * at.part * touch.stiffness;
    const double slower = s * touch.damping * along(STICK_DAMPING * std::sqrt(ContactLaw::STICK));
    give(TouchBound{&one, s * along(ContactLaw::STICK), slower, 1});
  };
  add_to_sums(a);
  if (b) add_to_sums(*b);
}

void TouchStep::press(Touch &touch, const TouchLaw &its_law, Solid &a, Solid *b, const Vec3 &own, double depth, double part,
                      const Vec3 &slope, const Vec3 &n) const
{
  const ContactLaw law = law_of(touch, its_law);
  ContactForce<double> push = pressure(touch, a, b, law, part, depth);
  Vec3 force = push.press * n;
  if (b && (slope.x != 0.0 || slope.y != 0.0 || slope.z != 0.0)) force -= push.surface_energy * b->in_space(slope);
  if (law.friction > 0.0) {
    const Vec3 from_anchor = own - touch.anchor;
    const Vec3 ran = this->ran(a, b);
    Vec3 away = (b ? b->in_space(from_anchor) : from_anchor) + ran;
    away -= dot(away, n) * n;    // the anchor follows along the normal
    friction(touch, law, part, away, n, ran, push);
    const Vec3 left = push.kept * away;
    touch.anchor = own - (b ? b->in_body(left) : left);
    force += push.pull + push.drag;
  }
  const Meeting at{b ? b->place(own) : own, n, depth, part};
  apply(a, b, at.x, force);
  book(a, b, touch, at, push);
}

Touch *TouchStep::meet(std::vector<Touch> &list, Touch::TouchKind kind, int number, const TouchLaw &law, Solid &a, Solid *b,
                       const Vec3 &x, const Vec3 &n, double depth, const Vec3 &anchor) const
{
  const auto found = find_touch(list, kind, number);
  if (depth <= 0.0) {
    if (found == list.end()) return nullptr;
    this->part(*found, a, b, {x, n, depth, 1.0});
    return nullptr;
  }
  if (found != list.end()) return &*found;
  Touch touch = born(kind, law, a, b, x, n);
  touch.first = number;
  touch.anchor = anchor;
  // A body that was so deep before it was seen overlaps.
  constexpr double SHALLOW = 0.03;
  const double before = depth + dt * dot(relative_velocity(a, b, x), n);
  if (is_first() || before > SHALLOW * a.shape.thin())
    overlaps(touch, depth);
  else
    came_from(touch, before);
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
  ContactForce<double> push = pressure(touch, a, b, law, at.part, at.depth);
  Vec3 force = push.press * at.n;
  if (slope) {
    force -= push.surface_energy * slope->by_place;
    turn(a, b, -push.surface_energy * slope->by_turn);
  }
  if (law.friction > 0.0) {
    // The way that the material of one went over that of the other, step by step.
    Vec3 away = b ? b->in_space(touch.anchor) : touch.anchor;
    const Vec3 ran = this->ran(a, b);
    away += dt * relative_velocity(a, b, at.x) + ran;
    away -= dot(away, at.n) * at.n;
    friction(touch, law, at.part, away, at.n, ran, push);
    const Vec3 left = push.kept * away;
    touch.anchor = b ? b->in_body(left) : left;
    force += push.pull + push.drag;
  }
  if (its_law.rolling > 0.0) resist_rolling(touch, its_law, a, b, at.n, at.part, push);
  apply(a, b, at.x, force);
  book(a, b, touch, at, push);
}

// Friction of the angle by which one rolled over the other, across n: of a moment of inertia I = 1/(1/I_a + 1/I_b) by their least
// ones, its spring has the frequency sqrt(ROLLS) Omega and holds up to the arm times the force of the contact.
void TouchStep::resist_rolling(Touch &touch, const TouchLaw &law, Solid &a, Solid *b, const Vec3 &n, double part,
                               ContactForce<double> &push) const
{
  constexpr double ROLLS = 0.1;                               // so it counts little in the bound
  const double damping = touch.damping / std::sqrt(ROLLS);    // the same share of critical damping
  const auto turns = [](const Solid &one) { return std::max({one.over.x, one.over.y, one.over.z}); };
  const double over = turns(a) + (b ? turns(*b) : 0.0), yields = a.yields + (b ? b->yields : 0.0);
  const double k = ROLLS * touch.stiffness * yields / over;
  Vec3 angle = b ? b->in_space(touch.rolled) : touch.rolled;
  angle += dt * (b ? a.spin - b->spin : a.spin);
  angle -= dot(angle, n) * n;
  ContactForce<double> torque;
  torque.press = push.press;
  const ContactLaw spring{k / ContactLaw::STICK, onset, law.rolling, damping};
  contact_friction<double>(spring, 1.0, part, angle, n, dt, touch.rolling, torque);
  const Vec3 left = torque.kept * angle, resists = torque.pull + torque.drag;
  touch.rolled = b ? b->in_body(left) : left;
  turn(a, b, resists);
  const auto add_to_sums = [&](Solid &one) {
    const double s = (b ? 2.0 : 1.0) * k;
    give(TouchBound{&one, s * turns(one), s * damping * turns(one), 0});
  };
  add_to_sums(a);
  if (b) add_to_sums(*b);
  push.heat += torque.heat;
  push.damped += torque.damped;
}

}    // namespace mdanim
