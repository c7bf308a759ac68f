// SPDX-License-Identifier: GPL-2.0-only

#include "joints/joint.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace mdanim {

static double stored(const SpringLaw &spring, double stretch) { return 0.5 * spring.k * stretch * stretch; }

// --- making ---

Joint::Joint(JointWords words, JointEnd a, JointEnd b, double length, double ftm2v)
    : given(std::move(words)), end_a(std::move(a)), end_b(std::move(b)), own_length(given.length.value_or(length)),
      directions(directions_of(given, end_a.patch, end_b.patch))
{
  for (const JointEnd *end : {&end_a, &end_b}) expect_place(end->patch, end->d);
  choose_laws(ftm2v);
  load_before();
  forget();
}

void Joint::forget()
{
  set_past({}, {});
  before.q = given.kind == JointKind::SPRING ? own_length : 0.0;
}

// If nothing else is said, all springs have the rate K (mobility of A + mobility of B) of the one between the two places.
void Joint::choose_laws(double ftm2v)
{
  const double mobility = ftm2v * (end_a.mobility() + end_b.mobility());
  law.k = given.stiffness ? *given.stiffness : *given.frequency * *given.frequency / mobility;
  law.c = given.damping_ratio ? *given.damping_ratio * 2.0 * std::sqrt(law.k / mobility) : given.damping;
  double of_directions = 0.0;
  for (const Vec3 *e = directions.held; e < directions.held + directions.many; ++e)
    of_directions = std::fmax(of_directions, ftm2v * (end_a.mobility_of_direction(*e) + end_b.mobility_of_direction(*e)));
  const double square = given.arm ? *given.arm * *given.arm : directions.many > 0 ? mobility / of_directions : 0.0;
  turning = {law.k * square, law.c * square};
  if (given.kind == JointKind::SLIDER && end_b.moves) {
    const Vec3 to_n = end_b.patch.velocity_of_direction(given.axis);
    lever[0] = 2.0 * ftm2v * dot(end_b.d, to_n) / mobility;
    lever[1] = ftm2v * dot(given.axis, to_n) / mobility;
  }
  const bool turns = given.kind == JointKind::HINGE;
  servo_mobility = turns
                       ? ftm2v * (end_a.mobility_of_direction(directions.across) + end_b.mobility_of_direction(directions.across))
                       : mobility;
  servo.k = given.servo ? given.servo->stiffness : law.k * mobility / servo_mobility;
  servo.c = given.servo ? given.servo->damping : 2.0 * std::sqrt(servo.k / servo_mobility);
  stop = given.stop ? SpringLaw{given.stop->stiffness, given.stop->damping} : servo;
  stop_mobility = given.stop ? given.stop->mobility : servo_mobility;
}

// Small motions of A that give the force -K g and the torque -K L^2 sum e x (phi x e) = -K L^2 n phi on it; n is 2 where three
// directions are held, and 1 across the axis of a hinge.
void Joint::load_before()
{
  place_in_a = end_a.d;
  for (int j = 0; j < directions.many; ++j) turned_in_a[j] = directions.held[j];
  if (!given.preload) return;
  if (end_a.patch.dimensions() < 3 || end_b.patch.dimensions() < 3)
    throw std::runtime_error("a preload needs particles that stand neither in a plane nor on a line, in both bodies");
  const auto across_axis = [&](const Vec3 &v) { return v - dot(v, given.axis) * given.axis; };
  const Vec3 force = given.kind == JointKind::SLIDER ? across_axis(given.preload->force) : given.preload->force;
  place_in_a += (-1.0 / law.k) * force;
  if (directions.many == 0) return;
  const bool turns = given.kind == JointKind::HINGE;
  const Vec3 torque = turns ? across_axis(given.preload->torque) : given.preload->torque;
  const Vec3 phi = (-1.0 / (turning.k * (turns ? 1.0 : 2.0))) * torque;
  for (int j = 0; j < directions.many; ++j) turned_in_a[j] += cross(phi, directions.held[j]);
}

// --- a step ---

Joint::Loads Joint::step(const PatchMotion &a, const PatchMotion &b, double dt, JointAccount &account)
{
  if (!is_broken()) {
    const Loads loads = find(a, b, {dt, dt}, before, spent_before, account);
    if (now.force <= given.breaks && now.torque <= given.breaks_torque) return loads;
    // Forces that do not act now have no part in the work of this step.
    account.heat += now.energy + 0.5 * dt * (loads.a.work(a.v, a.G) + loads.b.work(b.v, b.G));
    const double way = before.q;
    set_past({}, {});
    before.q = way, before.broken = 1;
  }
  now = Reading();
  now.at_a = a.point(place_in_a), now.at_b = b.point(end_b.d);
  return {};
}

Joint::Loads Joint::begin(const PatchMotion &a, const PatchMotion &b, double dt, bool anew)
{
  JointAccount none;
  if (is_broken()) return step(a, b, 0.0, none);
  Past past = before;
  Spending spending = spent_before;
  const Loads loads = find(a, b, {0.0, dt}, past, spending, none);
  if (anew || !before.began) set_past(past, spending);
  return loads;
}

// The work of a step is that of the mean of the forces before and after it on the way between: for particles what leap-frog gives
// them, for rigid bodies to second order.
Joint::Loads Joint::find(const PatchMotion &a, const PatchMotion &b, const Time &time, Past &past, Spending &spending,
                         JointAccount &account)
{
  Loads loads;
  Spending next;
  now = Reading();
  const Side of_a{end_a.patch, place_in_a, turned_in_a, a, loads.a, next.losses.a, next.motor.a};
  const Side of_b{end_b.patch, end_b.d, directions.held, b, loads.b, next.losses.b, next.motor.b};
  now.at_a = of_a.place(), now.at_b = of_b.place();
  const auto lent_by = [this](const Past &now) { return stored(servo, now.motor.stretch); };
  const auto kept_by = [this](const Past &now) { return stored(servo, now.brake.stretch) + stored(stop, now.depth); };
  const double lent = lent_by(past), kept = kept_by(past);
  if (given.kind == JointKind::SPRING)
    pull(of_a, of_b, past);
  else
    hold(of_b, of_a, time, past);
  past.began = 1;
  if (!spends()) return loads;
  next.c_a = a.c, next.F_a = a.F, next.c_b = b.c, next.F_b = b.F;
  const Vec3 dc_a = a.c - spending.c_a, dc_b = b.c - spending.c_b;
  const Matrix3 dF_a = a.F + -1.0 * spending.F_a, dF_b = b.F + -1.0 * spending.F_b;
  const auto work = [&](const Loads &first, const Loads &last) {
    return 0.5 * ((first.a.work(dc_a, dF_a) + first.b.work(dc_b, dF_b)) + (last.a.work(dc_a, dF_a) + last.b.work(dc_b, dF_b)));
  };
  account.heat -= work(spending.losses, next.losses) + kept_by(past) - kept;
  account.work += work(spending.motor, next.motor) + lent_by(past) - lent;
  for (const Loads *more : {&next.losses, &next.motor}) {
    loads.a += more->a;
    loads.b += more->b;
  }
  spending = next;
  return loads;
}

void Joint::pull(const Side &a, const Side &b, Past &past)
{
  const Vec3 way = now.at_b - now.at_a;
  past.q = length(way);
  const double more = past.q - own_length;
  now.gap = more;
  if (!(past.q > 0.0)) return;
  const Vec3 along = (1.0 / past.q) * way;
  now.rate = dot(along, b.velocity() - a.velocity());
  now.force = tension(law, more, now.rate, given.pulls_only);
  if (given.pulls_only && !(more > 0.0)) return;
  const double elastic = law.k * more;
  now.energy = 0.5 * elastic * more;
  a.springs.push(elastic * along, a.d);
  b.springs.push(-elastic * along, b.d);
  a.losses.push((now.force - elastic) * along, a.d);
  b.losses.push((elastic - now.force) * along, b.d);
}

void Joint::hold(const Side &base, const Side &moving, const Time &time, Past &past)
{
  // The springs.
  const bool slides = given.kind == JointKind::SLIDER, turns = given.kind == JointKind::HINGE;
  const Vec3 gap = moving.place() - base.place(), drawn = slides ? base.motion.F * given.axis : Vec3{};
  const double over_drawn = slides ? 1.0 / length(drawn) : 0.0;
  Vec3 axis = over_drawn * drawn;
  const double way = dot(axis, gap);
  const Vec3 off = gap - way * axis;
  const double softer = 1.0 / (1.0 + way * (lever[0] + way * lever[1])), k = softer * law.k;
  now.gap = length(off);
  now.energy = 0.5 * k * dot(off, off);
  Vec3 force = -k * off, torque;    // on what moves
  base.springs.push(-1.0 * force, base.d);
  moving.springs.push(force, moving.d);
  const auto push_along = [&](double along, PatchLoad &on_base, PatchLoad &on_moving) {
    on_base.push(-along * axis, base.d);
    on_moving.push(along * axis, moving.d);
    on_base.moment += outer((along * over_drawn) * off, given.axis);
  };
  if (slides) {
    base.springs.moment += outer((k * way * over_drawn) * off, given.axis);
    push_along(now.energy * softer * (lever[0] + 2.0 * way * lever[1]), base.springs, moving.springs);
  }
  for (int j = 0; j < directions.many; ++j) {
    const Vec3 &in_base = base.direction[j], &in_moving = moving.direction[j];
    const Vec3 turned = moving.motion.F * in_moving, apart = turned - base.motion.F * in_base, pull = -turning.k * apart;
    base.springs.moment += outer(-1.0 * pull, in_base);
    moving.springs.moment += outer(pull, in_moving);
    now.energy += 0.5 * turning.k * dot(apart, apart);
    torque += cross(turned, pull);
  }

  // Dashpots beside them, and the free coordinate.
  if (law.c > 0.0) force += damp(base, moving, softer * law.c, slides ? axis : Vec3{});
  if (turning.c > 0.0 && (turns || directions.many > 1)) brake(base, moving, torque);
  if (turns) turn(base, moving, time, past);
  if (slides) {
    past.q = way;
    now.rate = dot(axis, moving.velocity() - base.velocity()) + over_drawn * dot(off, base.motion.G * given.axis);
    const Driving driving = drive(now.rate, time, past);
    push_along(driving.losses, base.losses, moving.losses);
    push_along(driving.motor, base.motor, moving.motor);
  }
  now.force = length(force);
  now.torque = length(torque);
}

// The angle of a hinge is the one nearest to that before.
void Joint::turn(const Side &base, const Side &moving, const Time &time, Past &past)
{
  constexpr double TURN = 6.283185307179586;
  const Vec3 &n = given.axis;
  const HingeAngle now_at = hinge_angle(base.motion.F * directions.across, moving.motion.F * directions.across,
                                        base.motion.F * n + moving.motion.F * n);
  past.q = now_at.q + TURN * std::floor((past.q - now_at.q) / TURN + 0.5);
  now.rate = (dot(now_at.by_from, base.motion.G * directions.across) + dot(now_at.by_to, moving.motion.G * directions.across)) +
             dot(now_at.by_axes, base.motion.G * n + moving.motion.G * n);
  const auto push = [&](double torque, PatchLoad &on_base, PatchLoad &on_moving) {
    if (torque == 0.0) return;
    const Matrix3 by_axes = outer(torque * now_at.by_axes, n);
    (on_base.moment += outer(torque * now_at.by_from, directions.across)) += by_axes;
    (on_moving.moment += outer(torque * now_at.by_to, directions.across)) += by_axes;
  };
  const Driving driving = drive(now.rate, time, past);
  push(driving.losses, base.losses, moving.losses);
  push(driving.motor, base.motor, moving.motor);
}

// Dashpots of the rotation that is held.
void Joint::brake(const Side &base, const Side &moving, Vec3 &torque) const
{
  const PatchSpin of_base(base.patch, base.motion), of_moving(moving.patch, moving.motion);
  const Vec3 omega = of_moving.omega - of_base.omega;
  Vec3 couple = -turning.c * omega;
  if (given.kind == JointKind::HINGE) {
    const Vec3 axis = unit(base.motion.F * given.axis + moving.motion.F * given.axis);
    couple -= dot(couple, axis) * axis;
  }
  torque += couple;
  of_base.couple(-1.0 * couple, base.losses);
  of_moving.couple(couple, moving.losses);
}

// The force of the dashpot on what moves; there is none along `free`. It acts on those two material points that are at one place
// now, so that there is no couple: at the joint's place in what moves, or in the base where the patch of the base is flat.
Vec3 Joint::damp(const Side &base, const Side &moving, double c, const Vec3 &free) const
{
  Vec3 in_base = base.d, in_moving = moving.d;
  if (base.patch.dimensions() == 3)
    in_base = inverse(base.motion.F) * (moving.place() - base.motion.c);
  else if (moving.patch.dimensions() == 3)
    in_moving = inverse(moving.motion.F) * (base.place() - moving.motion.c);
  const Vec3 velocity = moving.motion.velocity(in_moving) - base.motion.velocity(in_base);
  const Vec3 force = c * (dot(velocity, free) * free - velocity);
  base.losses.push(-1.0 * force, in_base);
  moving.losses.push(force, in_moving);
  return force;
}

Joint::Driving Joint::drive(double rate, const Time &time, Past &past)
{
  Driving found;
  if (!given.has_servo()) return found;
  const SpringLaw stable{servo.k, implicit(servo.c, servo_mobility, time.step)};
  const auto move = [&](const Drive &how, DriveState &state) {
    state = driven(how, stable, state, past.q, rate, time.passed, !past.began);
    now.energy += stored(servo, state.stretch);
    return state.force;
  };
  if (given.motor) {
    Drive motor{given.motor->speed, given.motor->most, given.rise};
    // One without limit is stronger than the stops: it goes as far as these.
    if (given.limits && motor.most == HUGE_VAL) motor.low = given.limits->low, motor.high = given.limits->high;
    found.motor = move(motor, past.motor);
  }
  if (given.friction > 0.0) found.losses = move({0.0, given.friction}, past.brake);
  if (given.limits) {
    const SpringLaw its{stop.k, implicit(stop.c, stop_mobility, time.step)};
    const Stop reached = stopped(given.limits->low, given.limits->high, its, past.q, rate);
    past.depth = reached.depth;
    now.energy += stored(stop, reached.depth);
    found.losses += reached.force;
  }
  now.driving = found.motor + found.losses;
  return found;
}

}    // namespace mdanim
