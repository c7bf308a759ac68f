// SPDX-License-Identifier: GPL-2.0-only
// Lists of points that may touch, and the work of contacts in a step.

#include "contact/contact_field.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

static constexpr double AT_ONCE = -1.0;
static constexpr double TRUSTED = 1.0;    // cells to go, with which the last look at a point is still trusted in new lists

// --- lists ---

// A point counts until the centre of its area is a quarter of a cell beyond an edge. The drawn surface of a shape that is not a
// cuboid extends beyond its particles, and farther where cells are stretched.
double ContactField::stands_out(const ContactBody &owner, const ContactBody &host)
{
  if (!host.is_cuboid()) return STRETCHED * host.overhang();
  return 0.6 * (host.spacing() + (owner.is_cuboid() ? owner.spacing() : 0.0));
}

void ContactField::list(ContactObject &points_of, ContactObject &host_now, const PointFinder &finder, const Zone &zone,
                        const ContactArrays &arrays, double reach, double nearer)
{
  owner = &points_of, host = &host_now;

  std::vector<int> points_before(near.size());
  for (std::size_t q = 0; q < near.size(); ++q) points_before[q] = near.point(q);
  const std::vector<Watch> watch_before = std::move(watch);
  const Wakes wake_before = std::move(wake);
  const double spent = budget + nearer, trusted = TRUSTED * host->body->spacing();
  near.clear(), wake.clear(), watch.clear(), of_contact.clear();
  budget = 0.0;
  std::size_t before = 0, contact = 0;
  for (const int p : finder.inside(zone.grown(reach), host->body->is_cuboid(), contacts)) {
    while (contact < contacts.size() && contacts[contact].point < p) ++contact;
    const bool touches = contact < contacts.size() && contacts[contact].point == p;
    while (before < points_before.size() && points_before[before] < p) ++before;
    const CarriedPoint point(*owner, p);
    if (!point.is_there) continue;
    const double out = zone.outside(point.place(arrays.place()));
    const bool known = before < points_before.size() && points_before[before] == p;
    if (!touches && out > reach) continue;
    near.add(point);
    if (touches) of_contact.push_back(near.size() - 1);
    watch.push_back(known ? watch_before[before] : Watch{});
    const double seen = known && wake_before[before] < NEVER ? std::min(wake_before[before] - spent, trusted) : AT_ONCE;
    wake.push_back(touches ? NEVER : std::max({out, seen, AT_ONCE}));
  }
  keep_near(contacts, of_contact, near);
}

void ContactField::forget()
{
  near.clear(), wake.clear(), watch.clear(), of_contact.clear();
  budget = 0.0;
}

void ContactField::settle(const ContactArrays &arrays)
{
  for (std::size_t q = 0; q < near.size(); ++q)
    if (wake[q] < NEVER && wake[q] <= budget) look(q, arrays, false);
}

// Cost of a point that is looked at now and then, and of a contact.
int ContactField::cost() const
{
  constexpr std::size_t POINT = 5, CONTACT = 150;
  return static_cast<int>(POINT * near.size() + CONTACT * contacts.size());
}

// --- contacts ---

// The number of lanes of a block of contacts from number c on.
static int lanes_of(std::size_t c, std::size_t end) { return static_cast<int>(std::min<std::size_t>(CONTACT_LANES, end - c)); }

PushTask ContactField::task(PointKind kind, const ContactArrays &arrays, double dt) const
{
  const ContactBody &body = *host->body;
  const double longest = std::max({body.count(0) * body.edge(0), body.count(1) * body.edge(1), body.count(2) * body.edge(2)});
  return {
      law, dt, body.lattice(), host->slot.data(), arrays.place(), 2.0 * body.spacing() + longest, ramps(kind), is_smooth(kind)};
}

PointNow ContactField::point_now(std::size_t q, const ContactArrays &arrays) const
{ return {near.place(q, arrays.place()), near.shift(q, arrays.place()), surface_point(q).area}; }

// X of the point is that of the weights plus `off`; everything is linear about the former. False when it cannot be found.
bool ContactField::follow(FieldContact &contact, const PushTask &task, const Vec3 &x, MapWeights &weights, Spot<double> &spot,
                          Vec3 &off, Hop &hop) const
{
  constexpr int MOST = 12;
  const Placed at = {*host->body, task.slot, task.place};
  const MaterialSearch search(at);
  std::array<int, 3> cell = {contact.cell[0], contact.cell[1], contact.cell[2]};
  Vec3 X = contact.state.X + contact.state.change, left_at;
  bool again = true, has_left = false;
  hop = {};
  for (int step = 0; again; ++step) {
    if (step == MOST) return false;
    again = false;
    weights = task.is_smooth ? smooth(X, at.body) : trilinear(X, cell, at.body);
    if (!evaluate(at, weights, spot)) return false;
    if (search.is_collapsed(spot)) {    // the search starts at the last place, then from the cells around
      if (task.is_smooth) return false;
      Vec3 from = contact.state.X;
      cell = {contact.cell[0], contact.cell[1], contact.cell[2]};
      if (step > 0 || !(search.solve(x, cell, from) || search.solve_around(x, cell, from))) return false;
      X = from, again = true;
      continue;
    }
    off = spot.to_material(x - spot.x);
    const double square = dot(off, off);
    if (square > SAME_PLACE * SAME_PLACE) {
      X += (square > 1.0 ? 1.0 / std::sqrt(square) : 1.0) * off;
      again = true;
      continue;
    }
    if (has_left) hop.jump += (X + off) - left_at;
    has_left = !task.is_smooth && search.step_to_neighbour(cell, X + off, LEFT);
    if (has_left) {
      X += off;
      if (!hop.happened) hop = {true, spot.to_space(X - contact.state.X), {}};
      left_at = X;
      again = true;
    }
  }
  for (int d = 0; d < 3; ++d) contact.cell[d] = cell[d];
  X += off;
  contact.state.change = X - contact.state.X;
  contact.state.X = X;
  return true;
}

// Beyond the filled cells of a round host X is not continuous from cell to cell. The contact continues as if it were: a jump of
// its depth would create energy. The mean force of leap-frog acts half along the normal of the old cell and half along that of
// the new one, and the depth grows accordingly in this step.
void ContactField::go_on(FieldContact &contact, const Hop &hop, const Spot<double> &spot) const
{
  ContactState<double> &state = contact.state;
  const Depth<double> here = host->body->depth(contact.side, state.X);
  const double grown = host->body->depth(contact.side, state.X - hop.jump).value - state.memory.depth;
  const double grown_here = dot(spot.to_material(hop.moved), here.slope);
  const double deeper = here.value - (state.memory.depth + 0.5 * (grown + grown_here));
  state.memory.offset += deeper;
  state.memory.depth += deeper;
  state.anchor += hop.jump;
  state.change -= hop.jump;
}

ContactField::Fate ContactField::push(FieldContact &contact, std::size_t q, const PushTask &task, const PointNow &now,
                                      ContactArrays &arrays, ContactAccount &account) const
{
  const Placed at = {*host->body, task.slot, task.place};
  MapWeights weights;
  Spot<double> spot;
  Vec3 off, part_slope;
  Hop hop;
  if (!follow(contact, task, now.x, weights, spot, off, hop)) return Fate::LOST;
  if (!host->body->is_cuboid() && hop.happened) go_on(contact, hop, spot);
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
void ContactField::take(const FieldContact &contact, std::size_t q, const PushedBlock &pushed, int lane, ContactArrays &arrays,
                        ContactAccount &account) const
{
  const PushedContact<double> &found = pushed.contact[lane];
  if (pushed.hard) arrays.kernels->add_to_nodes(pushed, lane, lane + 1, arrays.force());
  near.add_force(q, contact.last.force, arrays.force());
  if (pushed.on_ramp >> lane & 1) near.add_force_at_centre(q, found.at_centre, arrays.force());
  count(contact, found.heat, found.damped, account);
}

void ContactField::count(const FieldContact &contact, double heat, double damped, ContactAccount &account) const
{
  account.energy += contact.last.energy;
  account.stick_energy += contact.state.memory.stick_energy;
  account.heat += heat;
  account.damped += damped;
  account.deepest = std::max(account.deepest, contact.state.memory.depth);
  ++account.touching;
}

// Turns a contact that is over into a point to be looked at.
void ContactField::end(const FieldContact &contact, std::size_t q, Fate fate, const ContactArrays &arrays,
                       ContactAccount &account)
{
  account.heat += contact.state.memory.stick_energy;
  // The last force still did work in half of the last step, as leap-frog counts it.
  if (fate == Fate::LOST) account.let_go += contact.last.energy - 0.5 * dot(contact.last.force, contact.last.moved);
  if (fate != Fate::OUT) {
    watch[q] = {};
  } else {
    watch[q].cell = {contact.cell[0], contact.cell[1], contact.cell[2]};
    watch[q].X = contact.state.X;
  }
  look(q, arrays, false);
}

void ContactField::look(const ContactArrays &arrays, double nearer, double dt)
{
  budget += nearer;
  if (dt > 0.0) wake.look_below(budget, [&](std::size_t q) { look(q, arrays, true); });
  now.clear();
  for (const std::size_t q : of_contact) now.push_back(point_now(q, arrays));
  known_ahead = 0;
}

// Calls run(first, end, task) for contacts from `first` to `end` - 1, all of points of one kind, from the first kind to the last.
template <class Do> void ContactField::each_run(double dt, const ContactArrays &arrays, const Do &run) const
{
  for (std::size_t first = 0, end = 0; first < contacts.size(); first = end) {
    const PointKind kind = surface_point(of_contact[first]).kind;
    while (end < contacts.size() && surface_point(of_contact[end]).kind == kind) ++end;
    run(first, end, task(kind, arrays, dt));
  }
}

void ContactField::work_ahead(const ContactArrays &arrays, double dt)
{
  if (!arrays.kernels) return;
  each_run(dt, arrays, [&](std::size_t first, std::size_t end, const PushTask &task) {
    for (std::size_t c = first; c < end; c += CONTACT_LANES) {
      if (known_ahead == ahead.size()) ahead.emplace_back();
      arrays.kernels->push(task, &contacts[c], &now[c], lanes_of(c, end), ahead[known_ahead++]);
    }
  });
}

void ContactField::add_forces(ContactArrays &arrays, double dt, ContactAccount &account)
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
  if (moves) contacts.resize(left), of_contact.resize(left);
  account.looks += looks;
  looks = 0;
}

// Moves the contacts, among those from `first` to `end` - 1, that continue to the places from `left` on; `block` counts those
// that were computed ahead.
void ContactField::push_run(std::size_t first, std::size_t end, std::size_t &left, std::size_t &block, const PushTask &task,
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
    if (left < c) contacts[left] = contacts[c], of_contact[left] = of_contact[c];
    ++left;
  }
}

std::size_t ContactField::bytes() const
{
  return near.bytes() + wake.bytes() + watch.capacity() * sizeof(Watch) + contacts.capacity() * sizeof(FieldContact) +
         now.capacity() * sizeof(PointNow) + ahead.capacity() * sizeof(PushedBlock) + of_contact.capacity() * sizeof(std::size_t);
}

}    // namespace mdanim
