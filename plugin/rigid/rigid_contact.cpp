// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/rigid_contact.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

namespace mdanim {

static constexpr std::size_t MOST_MOVING = 26;    // points that move over one body
// Costs of a body in a step beside its contacts, of a pair that is near, of a body at a plane, and of a contact; approximate.
static constexpr double NS_OF_BODY = 15.0, NS_OF_PAIR = 3.0, NS_OF_PLANE = 4.0, NS_OF_TOUCH = 200.0;

void RigidContact::take(std::vector<Solid> now)
{
  for (Solid &one : now) {    // a state that is put has the bodies that there were
    const int known = number_of(one.id);
    if (known < 0 || !one.take_yields(solids[known])) one.find_yields();
    one.settled = one.held && !one.driven && length(one.belt) == 0.0;
  }
  solids = std::move(now);
  beds.forget();
  forget();
}

int RigidContact::number_of(int id) const
{
  const auto found =
      std::lower_bound(solids.begin(), solids.end(), id, [](const Solid &one, int wanted) { return one.id < wanted; });
  return found != solids.end() && found->id == id ? static_cast<int>(found - solids.begin()) : -1;
}

void RigidContact::forget()
{
  near.pairs.clear();
  near.forget();
  watched.forget(solids.size(), settings.planes.size());
  is_active_known = false;
  at_plane.assign(settings.planes.size(), std::vector<std::vector<Touch>>(solids.size()));
  plane_push.clear();
}

void RigidContact::place(int n, const RigidBody &body)
{
  solids[n].put(body.centre, body.turn, body.velocity, body.spin);
  solids[n].fastest_turn = std::sqrt(dot(body.L, body.L)) * std::max({body.over.x, body.over.y, body.over.z});
}

// A pair may have friction and damping of its own.
TouchLaw RigidContactSettings::law_with(double yields, Material material, std::pair<int, int> ids) const
{
  const auto rolls = rolling.find(ids);
  const double arm = rolls != rolling.end() ? rolls->second : material.rolling;
  if (const auto own = pairs.find(ids); own != pairs.end()) material = own->second;
  return {frequency * frequency / yields, material.friction, material.damping, arm};
}

TouchLaw RigidContactSettings::law_of(const Solid &a, const Solid &b) const
{
  const Material &one = a.material, &other = b.material;
  double damping = std::max(one.damping, other.damping);
  if (one.gives_way != other.gives_way) damping = one.gives_way ? other.damping : one.damping;
  const Material usual{std::sqrt(one.friction * other.friction), damping, false, std::max(one.rolling, other.rolling)};
  return law_with(a.yields + b.yields, usual, {a.id, b.id});
}

TouchLaw RigidContactSettings::law_at(const Solid &one, int plane) const
{ return law_with(one.yields, one.material, {one.id, -1 - plane}); }

void RigidContact::touch_pair(const TouchStep &step, SolidPair &pair)
{
  Solid &a = solids[pair.a], &b = solids[pair.b];
  forget_parted(pair.touches);
  if (a.aside || b.aside || (a.whole != Solid::ALONE && a.whole == b.whole)) return;
  const double way = watched.gone(pair) - pair.gone;
  pair.gone += way;
  pair.asleep -= way;
  pair.known_for -= way;
  // Two bodies begin to touch within their spheres, and may go on touching beyond them, on ramps.
  if (pair.touches.empty()) {
    if (pair.asleep > 0.0) return;
    const double apart = length(a.centre - b.centre) - (a.shape.bound() + b.shape.bound());
    if (apart > 0.0) {
      pair.asleep = WatchedPairs::SURELY * apart;
      return;
    }
  }
  step.next(pair.touches);
  touch_solids(step, pair, a, b, settings.law_of(a, b));
  step.listed(pair.touches, {&a, &b, &pair});
}

// In the frame of a plane that moves, contact is as with one that stands. The work is -F dx of the plane with the mean of the
// forces before and after the step.
void RigidContact::touch_plane(const TouchStep &step, std::vector<Touch> &touches, Solid &one, int k)
{
  const SolidPlane &plane = settings.planes[k];
  const auto touch = [&] {
    if (touches.empty() && plane.above(one) > 0.0) return;
    step.next({});
    mdanim::touch_plane(step, touches, one, plane, settings.law_at(one, k));
    step.listed(touches, {&one, nullptr, nullptr, k});
  };
  if (!plane.moves) return touch();
  const Vec3 centre = one.centre, velocity = one.velocity, force = one.force;
  one.centre = centre - plane.shift, one.velocity = velocity - plane.velocity;
  touch();
  one.centre = centre, one.velocity = velocity;
  const Vec3 now = one.force - force;
  auto &before = plane_push[{k, one.id}];
  if (!step.is_first()) account.work += 0.5 * dot(before.value_or(Vec3{}) + now, plane.way);
  if (!step.is_first() || !before) before = now;
}

// Takes note of the bounds on the step of all bodies; returns the number of their contacts together.
static long see_bounds(const std::vector<Solid> &solids, double dt, TouchAccount &account)
{
  long touches = 0;
  for (const Solid &one : solids) {
    account.worst_bound = std::max(account.worst_bound, 0.25 * dt * dt * one.stiffness_sum + 0.5 * dt * one.damping_sum);
    account.most_touching = std::max(account.most_touching, one.touching);
    touches += one.touching;
  }
  return touches;
}

void RigidContact::step(double dt)
{
  const bool all = find_active(settings.objects && near.update(solids, settings.excluded));
  threads.all().parts(bodies(), NS_OF_BODY, [&](long first, long end) {
    for (int n = static_cast<int>(first); n < end; ++n) {
      if (unstirred[n] && !all) continue;
      solids[n].begin_step(dt);
      watched.go(n, solids[n].stir);
    }
  });
  const TouchStep step(dt, settings.onset, account);
  touch_planes(step, all);
  const auto pairs = static_cast<long>(all ? near.pairs.size() : active.size());
  const double ns =
      NS_OF_PAIR * static_cast<double>(pairs) + 0.5 * NS_OF_TOUCH * static_cast<double>(all_touches - touches_at_planes);
  threads.share(step, solids, account, pairs, ns, [&](const TouchStep &of_some, long first, long end) {
    watched.each(all ? nullptr : &active, first, end, near.pairs, [&](int k) { touch(of_some, k, all); });
  });
  if (!step.is_first())
    for (const auto &[one, force] : step.share_blows()) push_more(one, force);
  all_touches = see_bounds(solids, dt, account);
}

// Planes that move add to sums of their own, one after the other.
void RigidContact::touch_planes(const TouchStep &step, bool all)
{
  const bool stand = settings.planes_stand();
  const auto is_at_rest = [stand](const Solid &one) { return stand && one.settled; };
  const auto touch_some = [&](const TouchStep &of_some, long first, long end) {
    int k = first < end ? static_cast<int>(first / bodies()) : 0, n = static_cast<int>(first - 1L * k * bodies());
    for (long number = first; number < end; ++number, ++n) {
      if (n == bodies()) ++k, n = 0;
      Solid &one = solids[n];
      if (!watched.may_touch(k, n) || one.held || one.aside || is_at_rest(one)) continue;
      std::vector<Touch> &touches = at_plane[k][n];
      forget_parted(touches);
      touch_plane(of_some, touches, one, k);
      if (length(settings.planes[k].velocity) > 0.0 && !touches.empty()) of_some.carry(one);
      watched.watch(k, n, settings.planes[k].moves || !touches.empty() ? 0.0 : settings.planes[k].above(one));
    }
  };
  const long size = static_cast<long>(settings.planes.size()) * bodies();
  const double ns = NS_OF_PLANE * static_cast<double>(size) + NS_OF_TOUCH * static_cast<double>(touches_at_planes);
  threads.share(step, solids, account, size, stand ? ns : 0.0, touch_some);
  touches_at_planes = 0;
  for (std::size_t n = 0; n < solids.size(); ++n) {
    Solid &one = solids[n];
    touches_at_planes += one.touching;
    if (!is_at_rest(one))
      one.force_at_planes = one.force, one.torque_at_planes = one.torque;
    else if (all || !unstirred[n])
      one.force = one.force_at_planes, one.torque = one.torque_at_planes;
  }
}

void RigidContact::rest(int n, bool asleep, bool settled)
{
  Solid &one = solids[n];
  is_active_known = is_active_known && one.settled == settled;
  one.asleep = asleep;
  one.settled = settled;
}

// Pairs of which one is not settled, and all others of what is near it. In the step in which these are found anew all pairs are
// looked at: it gives bodies that are settled the forces that they keep.
bool RigidContact::find_active(bool listed_anew)
{
  if (!listed_anew && is_active_known) return false;
  const auto is_settled = [this](const SolidPair &pair) { return solids[pair.a].settled && solids[pair.b].settled; };
  const bool stand = settings.planes_stand();
  unstirred.clear();
  for (const Solid &one : solids) unstirred.push_back(one.settled && !one.held && stand);
  for (const SolidPair &pair : near.pairs)
    if (!is_settled(pair)) unstirred[pair.a] = unstirred[pair.b] = 0;
  active.clear();
  const auto is_stirred = [this](int n) { return !solids[n].held && !unstirred[n]; };
  for (std::size_t k = 0; k < near.pairs.size(); ++k)
    if (const SolidPair &pair = near.pairs[k]; !is_settled(pair) || is_stirred(pair.a) || is_stirred(pair.b))
      active.push_back(static_cast<int>(k));
  watched.take(near.pairs);
  is_active_known = true;
  return true;
}

// Whether the force of a pair is kept.
static bool is_counted(const Solid &a, const Solid &b)
{ return a.whole != Solid::ALONE || b.whole != Solid::ALONE || a.asleep || b.asleep; }

// Bodies that sleep give to each other what they gave in the last step in which one was awake or had just been put to sleep.
void RigidContact::touch(const TouchStep &step, int k, bool all)
{
  SolidPair &pair = near.pairs[k];
  Solid &a = solids[pair.a], &b = solids[pair.b];
  if (a.settled && b.settled) {
    if (pair.touches.empty()) return;
    if (all || !unstirred[pair.a]) step.push({&a, nullptr, pair.force, pair.torque_a, {}});
    if (all || !unstirred[pair.b]) step.push({&b, nullptr, -1.0 * pair.force, pair.torque_b, {}});
    return;
  }
  is_counted(a, b) ? touch_counted(step, pair) : touch_pair(step, pair);
  watched.watch(k, pair);
  if (b.driven && b.stir > 0.0 && !pair.touches.empty()) step.carry(a);
  if (a.driven && a.stir > 0.0 && !pair.touches.empty()) step.carry(b);
}

bool RigidContact::lay_aside(int n, bool aside)
{
  if (solids[n].aside == aside) return false;
  solids[n].aside = aside;
  is_active_known = false;
  for (auto &of_plane : at_plane) of_plane[n].clear();
  for (int k = 0; k < static_cast<int>(settings.planes.size()); ++k) {
    plane_push.erase({k, solids[n].id});
    watched.watch(k, n, 0.0);
  }
  for (SolidPair &pair : near.pairs)
    if (pair.a == n || pair.b == n) pair.end();
  return true;
}

void RigidContact::glue(int n, int whole, const Carrier &carrier, const std::vector<char> &faces)
{
  Solid &one = solids[n];
  beds.forget();
  one.whole = whole, one.carrier = carrier;
  one.find_yields();
  if (!faces.empty()) one.shape.cover(faces);
}

// How a dashpot is damped depends on stiffness times mobility, and stays. What is remembered of the step before was of the harder
// contact.
static void soften(std::vector<Touch> &touches, double part)
{
  for (Touch &touch : touches) {
    touch.stiffness *= part;
    touch.yields /= part;
    touch.alone /= part;
    touch.owed *= part;
    touch.memory.stick *= part;
    touch.memory.stick_energy *= part;
    touch.memory.pull = part * touch.memory.pull;
    touch.press *= part;
    touch.memory.damping = touch.more = 0.0;
    touch.memory.drag = Vec3();
  }
}

static double energy_of(const std::vector<Touch> &touches)
{
  double all = 0.0;
  for (const Touch &touch : touches) all += touch.energy;
  return all;
}

double RigidContact::change(const std::map<int, double> &yielded)
{
  const auto part = [](double was, double is) { return std::min(1.0, was / is); };
  const auto was = [&](int n) {
    const auto found = yielded.find(n);
    return found == yielded.end() ? solids[n].yields : found->second;
  };
  const double booked = account.heat + account.damped + account.let_go;
  const TouchStep step = TouchStep::where_glue_breaks(settings.onset, account);
  double gone = 0.0;
  for (const auto &[n, yielded_before] : yielded) {
    Solid &one = solids[n];
    one.force -= one.force_at_planes;
    one.torque -= one.torque_at_planes;
    const Vec3 force = one.force, torque = one.torque;
    for (std::size_t k = 0; k < settings.planes.size(); ++k) {
      std::vector<Touch> &touches = at_plane[k][n];
      gone += energy_of(touches);
      soften(touches, part(yielded_before, one.yields));
      forget_parted(touches);
      touch_plane(step, touches, one, static_cast<int>(k));
      gone -= energy_of(touches);
    }
    one.force_at_planes = one.force - force;
    one.torque_at_planes = one.torque - torque;
  }
  if (settings.objects) {
    near.forget();    // pieces are near others that they were not before
    is_active_known = false;
    near.update(solids, settings.excluded);
    for (SolidPair &pair : near.pairs) {
      if (!yielded.count(pair.a) && !yielded.count(pair.b)) continue;
      Solid &a = solids[pair.a], &b = solids[pair.b];
      pair.take_back(a, b);
      gone += energy_of(pair.touches);
      soften(pair.touches, part(was(pair.a) + was(pair.b), a.yields + b.yields));
      pair.forget();
      touch_counted(step, pair);
      gone -= energy_of(pair.touches);
    }
  }
  return gone - (account.heat + account.damped + account.let_go - booked);
}

void RigidContact::push_more(const InBlow &one, const Vec3 &force)
{
  one.push(force);
  if (one.b) {
    if (is_counted(*one.a, *one.b)) one.pair->add(one.a == &solids[one.pair->a], one, force);
  } else if (settings.planes[one.plane].moves) {
    account.work += 0.5 * dot(force, settings.planes[one.plane].way);
    std::optional<Vec3> &pushed = plane_push[{one.plane, one.a->id}];
    pushed = pushed.value_or(Vec3{}) + force;
  }
}

// Keeps what the pair gives to bodies that may come apart.
void RigidContact::touch_counted(const TouchStep &step, SolidPair &pair)
{
  LateSums *const late_ones = step.late_sums();
  if (!late_ones) return pair.keep(solids[pair.a], solids[pair.b], [&] { touch_pair(step, pair); });
  const std::size_t from = late_ones->size();
  touch_pair(step, pair);
  late_ones->end_kept(pair, from);
}

const TouchAccount &RigidContact::found()
{
  account.energy = 0.0;
  account.touching = 0;
  each_touch([this](const Touch &touch) { account.energy += touch.energy, account.touching += touch.parted == 0.0; });
  return account;
}

// Contacts of bodies that sleep are not looked at in the run.
void RigidContact::begin_account()
{
  account.deepest = account.worst_bound = 0.0;
  account.most_touching = 0;
  if (settings.sleeps) each_touch([this](const Touch &touch) { account.deepest = std::max(account.deepest, depth_of(touch)); });
}

std::size_t RigidContact::bytes() const { return solids.capacity() * sizeof(Solid) + near.bytes(); }

// --- records ---

Bytes RigidContact::record_of(const SolidPair &pair) const
{
  ByteWriter writer;
  const bool is_kept = solids[pair.a].asleep || solids[pair.b].asleep;
  if (settings.sleeps)
    for (const Vec3 &part : {pair.force, pair.torque_a, pair.torque_b}) writer.put(is_kept ? part : Vec3());
  return writer.put_counted(pair.touches).take();
}

void RigidContact::put_at_planes(int n, ByteWriter &writer) const
{
  if (settings.sleeps) writer.put(solids[n].force_at_planes).put(solids[n].torque_at_planes);
  for (const auto &of_plane : at_plane) writer.put_counted(of_plane[n]);
  for (int k = 0; k < static_cast<int>(settings.planes.size()); ++k) {
    if (!settings.planes[k].moves) continue;
    const auto push = plane_push.find({k, solids[n].id});
    writer.put(push == plane_push.end() ? Vec3{} : push->second.value_or(Vec3{}));
  }
}

// Features that the shapes have, and finite numbers.
static void check(const std::vector<Touch> &touches, const Solid &a, const Solid *b, const ByteReader &reader)
{
  const auto corners = [](const Solid &one) { return std::max<std::size_t>(one.shape.corners().size(), 1); };
  const auto edges = [](const Solid &one) { return one.shape.edges().size(); };
  const auto curves = [](const Solid &one) { return one.shape.curves().size(); };
  const auto sides = [&](const Solid *one) {
    if (!one) return std::size_t(1);
    return std::max<std::size_t>(one->shape.sides(), 1);
  };
  for (const Touch &touch : touches) {
    std::size_t first = 0, second = 1, side = 1;
    if (touch.kind == Touch::CORNER) first = corners(a), side = sides(b);
    if (touch.kind == Touch::CORNER_OF_OTHER && b) first = corners(*b), side = sides(&a);
    if (touch.kind == Touch::EDGES && b) first = edges(a), second = edges(*b);
    if (touch.kind == Touch::CURVES && b) first = curves(a), second = curves(*b);
    if (touch.kind == Touch::MOVING) first = MOST_MOVING, side = sides(b);
    if (touch.kind == Touch::MOVING_OF_OTHER) first = MOST_MOVING, side = sides(&a);
    const auto is_below = [](std::int32_t number, std::size_t count) {
      return number >= 0 && static_cast<std::size_t>(number) < count;
    };
    if (!is_below(touch.first, first) || !is_below(touch.second, second) || !is_below(touch.side, side))
      reader.fail("has contacts of features that there are not");
    double values[(sizeof(Touch) - offsetof(Touch, stiffness)) / sizeof(double)];
    std::memcpy(values, reinterpret_cast<const char *>(&touch) + offsetof(Touch, stiffness), sizeof values);
    reader.expect_numbers(values, "a number of a contact");
  }
}

static Vec3 read_vector(ByteReader &reader)
{
  const auto found = reader.get<Vec3>();
  const double values[] = {found.x, found.y, found.z};
  reader.expect_numbers(values, "a force of contact");
  return found;
}

void RigidContact::read_at_planes(int n, ByteReader &reader)
{
  if (settings.sleeps) solids[n].force_at_planes = read_vector(reader), solids[n].torque_at_planes = read_vector(reader);
  for (auto &of_plane : at_plane) {
    of_plane[n] = reader.get_counted<Touch>();
    check(of_plane[n], solids[n], nullptr, reader);
  }
  for (int k = 0; k < static_cast<int>(settings.planes.size()); ++k) {
    if (!settings.planes[k].moves) continue;
    plane_push[{k, solids[n].id}] = read_vector(reader);
  }
}

void RigidContact::read_pair(int a, int b, ByteReader &reader)
{
  SolidPair pair;
  pair.a = a;
  pair.b = b;
  if (settings.sleeps) {
    for (Vec3 *const part : {&pair.force, &pair.torque_a, &pair.torque_b}) *part = read_vector(reader);
  }
  pair.touches = reader.get_counted<Touch>();
  check(pair.touches, solids[a], &solids[b], reader);
  if (solids[a].aside || solids[b].aside) return;
  is_active_known = false;
  near.pairs.push_back(std::move(pair));
}

}    // namespace mdanim
