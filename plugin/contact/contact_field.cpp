// SPDX-License-Identifier: GPL-2.0-only
// When points are looked at, and what a contact does in a step.

#include "contact/contact_field.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace mdanim {

static constexpr double LEAST_COSINE = 0.45;    // between the outward normals of the point and of a side that faces it, negated
static constexpr double DEEPEST_BIRTH = 0.5;    // cells
static constexpr double AT_ONCE = -1.0;
static constexpr double NEVER = std::numeric_limits<double>::infinity();
static constexpr double LOST = 0.02;      // cells to go before a point that was not found is looked for again
static constexpr double PRESSED = 0.5;    // cells are taken to be pressed to half at most: motion in space over that in X
static constexpr double NEAREST = 2.2;    // cells from the middle of a cell on the surface beyond which there is no contact
static constexpr double JUMP = 0.25;      // cells that X may jump between cells of a round host
static constexpr std::uint8_t EVERY_SIDE = 63;
static constexpr int MOST_GUESSES = 3;
static constexpr double NEAR_PLACE = 0.1;    // cells that a guess may be off its last one

static double outside(const Box &box, const Vec3 &x)
{
  double out = -NEVER;
  for (int d = 0; d < 3; ++d) out = std::max({out, box.low(d) - component(x, d), component(x, d) - box.high(d)});
  return out;
}

// --- lists ---

void ContactField::list(ContactObject &points_of, ContactObject &host_now, const PointFinder &finder, const ContactArrays &arrays,
                        double reach)
{
  owner = &points_of, host = &host_now;
  host_box = host->box;
  // A sharp point counts until the centre of its area is a quarter of a cell beyond an edge; the drawn surface of what is no
  // cuboid stands out of its particles.
  const double stands_out = 0.6 * owner->body->spacing() + (host->body->is_cuboid() ? 0.6 : 1.25) * host->body->spacing();

  std::vector<int> points_before(near.size());
  for (std::size_t q = 0; q < near.size(); ++q) points_before[q] = near.point(q);
  const std::vector<Watch> watch_before = std::move(watch);
  near.clear(), wake.clear(), watch.clear(), of_contact.clear();
  budget = 0.0;
  std::size_t before = 0, contact = 0;
  std::vector<int> candidates;
  {
    const std::vector<int> inside = finder.inside(host_box.grown(reach + 1.01 * stands_out));
    std::vector<int> touching;
    for (const FieldContact &one : contacts) touching.push_back(one.point);
    std::set_union(inside.begin(), inside.end(), touching.begin(), touching.end(), std::back_inserter(candidates));
  }
  for (const int p : candidates) {
    while (contact < contacts.size() && contacts[contact].point < p) ++contact;
    const bool touches = contact < contacts.size() && contacts[contact].point == p;
    while (before < points_before.size() && points_before[before] < p) ++before;
    // Points of a cuboid are a cell apart, too few for what is curved: its own points are dense.
    if (owner->body->points()[p].kind != PointKind::DENSE && !host->body->is_cuboid()) continue;
    if (!near.add(*owner, p)) continue;
    const double out = outside(host_box, near.place(near.size() - 1, arrays.place())) - stands_out;
    const bool known = before < points_before.size() && points_before[before] == p;
    if (!touches && out > reach) {
      near.drop_last();
      continue;
    }
    if (touches) of_contact.push_back(near.size() - 1);
    watch.push_back(known ? watch_before[before] : Watch{});
    // How far all has gone in this step is not known: what is not far away is looked at.
    wake.push_back(touches ? NEVER : std::max(out, AT_ONCE));
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

// --- points without a contact ---

// Of a cuboid.
std::array<int, 3> ContactField::cell_of(const Vec3 &X) const
{
  const auto along = [&](double at, int axis) {
    return std::clamp(static_cast<int>(std::floor(at + LEFT)), 0, host->body->count(axis) - 1);
  };
  return {along(X.x, 0), along(X.y, 1), along(X.z, 2)};
}

// Of another shape, for a point at x whose X was found from `cell`: where X is beyond all filled cells it depends on the cell, so
// that is the one whose middle is nearest, wherever the search came from. `room`: a motion that cannot change the cell [m].
std::array<int, 3> ContactField::cell_beyond(const Vec3 &x, const Vec3 &X, std::array<int, 3> cell, const Placed &at,
                                             double &room) const
{
  const Vec3 off = X - Vec3{cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5};
  const double inside = 0.5 - std::max({std::fabs(off.x), std::fabs(off.y), std::fabs(off.z)});
  if (inside >= -LEFT) {
    room = PRESSED * std::max(inside, 0.0) * host->body->spacing();
    return cell;
  }
  for (;;) {
    std::array<int, 3> best = cell;
    double least = NEVER, second = NEVER;
    for (int k = cell[2] - 1; k <= cell[2] + 1; ++k)
      for (int j = cell[1] - 1; j <= cell[1] + 1; ++j)
        for (int i = cell[0] - 1; i <= cell[0] + 1; ++i) {
          if (!at.body.is_filled(i, j, k)) continue;
          const int low = at.slot[at.body.place(i, j, k)], high = at.slot[at.body.place(i + 1, j + 1, k + 1)];
          if (low < 0 || high < 0) continue;
          const Vec3 away = 0.5 * (at.place[low].value + at.place[high].value) - x;
          const double square = dot(away, away);
          second = std::min(second, std::max(square, least));
          if (square < least) least = square, best = {i, j, k};
        }
    if (best == cell) {
      room = PRESSED * (std::sqrt(second) - std::sqrt(least));    // each of the two distances grows and shrinks as much at most
      return cell;
    }
    cell = best;
  }
}

// X of a point at x by one step of Newton's method from where it was found last; `off`: how far that is in cells, 1 and more
// where the step says nothing. A small part of the work of find().
void ContactField::guess(std::size_t q, const Vec3 &x, const Placed &at, Spot<double> &spot, Vec3 &X, double &off)
{
  constexpr double HEALTHY = 0.7, NEARBY = 3.0;    // volume over that of a cell; cells from the middle of one
  Watch &known = watch[q];
  const bool by_splines = is_smooth(surface_point(q).kind);
  const double h = host->body->spacing();
  off = NEVER;
  if (!evaluate(at, by_splines ? smooth(known.X, at.body) : trilinear(known.X, known.cell, at.body), spot)) return;
  if (!(spot.det > HEALTHY * h * h * h)) return;
  const Vec3 change = spot.to_material(x - spot.x);
  X = known.X + change;
  const double square = dot(change, change);
  if (!(square < 1.0)) return;
  std::array<int, 3> cell = known.cell;
  bool is_there = true;
  if (by_splines)
    cell = cell_of(X);
  else
    is_there = !MaterialSearch(at).step_to_neighbour(cell, X, LEFT);
  double room = NEVER;
  if (!at.body.is_cuboid() && cell_beyond(x, X, cell, at, room) != cell) return;
  const Vec3 away = X - Vec3{cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5};
  if (dot(away, away) > NEARBY * NEARBY) return;
  known.cell = cell, known.X = X, known.room = room;
  off = is_there ? std::sqrt(square) : 1.0;
}

// X of a point at x, the same bits whatever was known of it: the last search begins in the middle of the cell that X lies in.
bool ContactField::find(std::size_t q, const Vec3 &x, const Placed &at, Spot<double> &spot, Vec3 &X)
{
  Watch &known = watch[q];
  const MaterialSearch search(at);
  std::array<int, 3> cell = known.cell;
  X = known.X;
  if (!search.solve(x, cell, X)) return false;
  known.room = NEVER;
  cell = host->body->is_cuboid() ? cell_of(X) : cell_beyond(x, X, cell, at, known.room);
  X = {cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5};
  if (!search.solve(x, cell, X, false)) return false;
  known.cell = cell, known.X = X;
  if (is_smooth(surface_point(q).kind)) return search.solve_smooth(x, X) && evaluate(at, smooth(X, *host->body), spot);
  return evaluate(at, trilinear(X, cell, at.body), spot);
}

bool ContactField::world_normal(const SurfacePoint &point, const ContactArrays &arrays, Vec3 &normal) const
{
  const Placed own = {*owner->body, owner->slot.data(), arrays.place()};
  const std::array<int, 3> cell = {point.cell[0], point.cell[1], point.cell[2]};
  Spot<double> spot;
  if (!evaluate(own, trilinear({cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5}, cell, *owner->body), spot)) return false;
  const ContactBody &body = *owner->body;
  normal = spot.gradient({point.normal.x * body.edge(0), point.normal.y * body.edge(1), point.normal.z * body.edge(2)});
  const double length = std::sqrt(dot(normal, normal));
  if (!(length > 0.0)) return false;
  normal = (1.0 / length) * normal;
  return true;
}

// Half of a flat point counts a cell and a half inside of an edge, half of others on the edge.
Ramps ContactField::ramps(PointKind kind) const
{
  Ramps ramps;
  for (int d = 0; d < 3; ++d) {
    const double rise = kind == PointKind::FLAT ? std::min(1.0, 0.25 * host->body->count(d)) : 0.5;
    ramps.width[d] = rise / (1.0 - Ramp<double>::ROUND);
    ramps.from[d] = (kind == PointKind::FLAT ? 1.5 * rise : 0.0) - 0.5 * ramps.width[d];
  }
  return ramps;
}

ContactField::Verdict ContactField::judge(const SurfacePoint &point, const Vec3 &X, const Vec3 &X_centre,
                                          const Spot<double> &spot, const Vec3 &normal, double off) const
{
  const double far = 1e-5 + off * off, turn = 1e-3 + 0.5 * off;    // that a depth and a cosine of a guess may be wrong, in cells
  const Lattice grid = host->body->lattice();
  const Ramps near_edges = ramps(point.kind);
  const double h = host->body->spacing();
  int side = -1;
  bool is_shut = false, is_surely_shut = false, may_face = false;
  double best = NEVER, until = 0.0, slack = NEVER;
  Verdict verdict;
  for (int s = 0; s < host->body->sides(); ++s) {
    const Depth<double> below = host->body->depth(s, X);
    const double depth = below.value / h;    // in cells
    const Vec3 inward = spot.gradient(below.slope);
    const double cosine = dot(normal, inward) / std::sqrt(dot(inward, inward));
    // What must change before the side can begin a contact, in cells: the largest of these three.
    double apart = -depth;
    const double turned = PRESSED * (LEAST_COSINE - cosine);
    if (host->body->is_cuboid())
      for (int d = 0; d < 3; ++d) {
        if (d == s / 2) continue;
        const double inside = std::min(component(X_centre, d), grid.cells[d] - component(X_centre, d));
        apart = std::max(apart, near_edges.from[d] - inside);
      }
    if (apart <= 0.0 || turned > apart) verdict.open |= static_cast<std::uint8_t>(1u << s);
    verdict.is_sure &= std::fabs(apart - std::max(0.0, turned)) > (turned > 0.0 ? turn : far);
    is_surely_shut |= turned < -turn && depth < -far;
    may_face |= turned < turn && depth > -far;
    slack = std::min(slack, PRESSED * h * std::max({apart, turned, depth - DEEPEST_BIRTH}));
    if (cosine < LEAST_COSINE) continue;
    if (depth <= 0.0) {
      is_shut = true;
      until = std::max(until, std::min(-PRESSED * depth * h, 0.5 * PRESSED * h * (cosine - LEAST_COSINE)));
    } else if (depth / cosine < best) {
      best = depth / cosine, side = s;
      verdict.depth = below.value;
    }
  }
  verdict.is_sure &= is_surely_shut || !may_face;
  verdict.slack = is_shut ? std::max(slack, until) : slack;
  const auto counts = [&] {
    Vec3 slope;
    return !host->body->is_cuboid() || part_that_counts<double>(near_edges, grid, X_centre, side / 2, slope) > 0.0;
  };
  if (!is_shut && side >= 0 && verdict.depth <= DEEPEST_BIRTH * h && counts()) verdict.side = side;
  return verdict;
}

// Whether a contact begins; else when to look again.
bool ContactField::look(std::size_t q, const ContactArrays &arrays, bool may_begin)
{
  Watch &known = watch[q];
  const SurfacePoint &point = surface_point(q);
  const Vec3 x = near.place(q, arrays.place());
  const double h = host->body->spacing();
  const Placed at = placed(arrays);
  const auto lost = [&] {
    known.cell = {-1, -1, -1};
    known.open = EVERY_SIDE;
    wake[q] = budget + LOST * h;
    return false;
  };
  if (known.cell[0] < 0) {
    if (!host->outer) host->outer = std::make_shared<const OuterCells>(*host, arrays);
    const std::array<int, 3> cell = host->outer->nearest(x);
    Spot<double> there;
    const Vec3 middle = {cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5};
    if (cell[0] >= 0 && !evaluate(at, trilinear(middle, cell, at.body), there)) return lost();
    const double away = cell[0] < 0 ? 0.5 * OuterCells::SEARCHED * h : std::sqrt(dot(x - there.x, x - there.x));
    if (away > NEAREST * h) {
      known.open = 0;
      wake[q] = budget + away - NEAREST * h;
      return false;
    }
    known.cell = cell, known.X = middle;
  }
  Spot<double> spot;
  Vec3 X, normal;
  const Vec3 shift = near.shift(q, arrays.place());
  if (!world_normal(point, arrays, normal)) return lost();
  const std::uint8_t was_open = known.open;
  Verdict verdict;
  verdict.is_sure = false;
  double off = 1.0;
  for (int step = 0; step < MOST_GUESSES && !verdict.is_sure && off > SAME_PLACE && off < NEVER; ++step) {
    guess(q, x, at, spot, X, off);
    if (off < NEAR_PLACE) verdict = judge(point, X, X + spot.to_material(shift), spot, normal, off);
  }
  if (!verdict.is_sure) {
    if (!find(q, x, at, spot, X)) return lost();
    verdict = judge(point, X, X + spot.to_material(shift), spot, normal, 0.0);
  }
  known.open = verdict.open;
  if (!may_begin || verdict.side < 0) {
    // In another cell the depth may be another one.
    const double slack = std::min(verdict.slack, std::max(known.room, verdict.slack - PRESSED * JUMP * h));
    wake[q] = budget + std::max(0.0, slack);
    return false;
  }

  FieldContact contact{};
  contact.point = near.point(q);
  contact.side = verdict.side;
  for (int d = 0; d < 3; ++d) contact.cell[d] = known.cell[d];
  contact.state.X = contact.state.anchor = X;
  contact.state.memory.depth = verdict.depth;
  contact.state.memory.offset = was_open >> verdict.side & 1 ? verdict.depth : 0.0;
  const auto where = std::lower_bound(of_contact.begin(), of_contact.end(), q);
  contacts.insert(contacts.begin() + (where - of_contact.begin()), contact);
  of_contact.insert(where, q);
  wake[q] = NEVER;
  return true;
}

// --- contacts ---

PushTask ContactField::task(PointKind kind, const ContactArrays &arrays, double dt) const
{
  const ContactBody &body = *host->body;
  const double longest = std::max({body.count(0) * body.edge(0), body.count(1) * body.edge(1), body.count(2) * body.edge(2)});
  return {
      law, dt, body.lattice(), host->slot.data(), arrays.place(), 2.0 * body.spacing() + longest, ramps(kind), is_smooth(kind)};
}

PointNow ContactField::point_now(std::size_t q, const ContactArrays &arrays) const
{ return {near.place(q, arrays.place()), near.shift(q, arrays.place()), surface_point(q).area}; }

// X of the point is that of the weights plus `off`, about which everything is linear. False when it cannot be found.
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
    if (search.is_collapsed(spot)) {    // from the last place, then from the cells around
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

// Beyond the filled cells of a round host X is not continuous from cell to cell. The contact goes on as if it were: a jump of
// its depth would be energy out of nothing. The mean force of leap-frog acts half along the normal of the cell that is left, half
// along that of the new one, and so does the depth grow in this step.
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
  const Depth<double> below = host->body->depth(contact.side, contact.state.X);
  double part = 1.0;
  if (host->body->is_cuboid())
    part = part_that_counts<double>(task.ramps, task.host, contact.state.X + shift, contact.side / 2, part_slope);
  if (!(below.value > std::min(contact.state.memory.offset, 0.0) && part > 0.0 && below.value <= task.longest)) {
    if (task.dt > 0.0) account.damped += last_damping_work(contact.state.memory, below.value);
    return Fate::OUT;
  }

  Vec3 turn;
  if (task.is_smooth && is_on_ramp(part_slope)) {
    const int row = at.body.row(), layer = at.body.layer(), *const slots = at.slot + weights.base;
    turn = part_turn(
        weights.axis, [&](int i, int j, int k) { return at.place[slots[i + row * j + layer * k]].value; }, spot, part_slope,
        shift);
  }
  const ContactPush<double> push =
      contact_push(task.law, task.dt, now.area, part, part_slope, turn, below, spot, off, shift, contact.state);
  contact.force = push.on_point;
  contact.moved = push.moved;
  contact.energy = push.energy;

  Row *on = arrays.force();
  near.add_force(q, push.on_point, on);
  if (is_on_ramp(part_slope)) near.add_force_at_centre(q, push.at_centre, on);
  spread(at, weights, -1.0 * push.both, {-1.0 * push.moment[0], -1.0 * push.moment[1], -1.0 * push.moment[2]}, on);
  count(contact, push.heat, push.damped, account);
  return Fate::STAYS;
}

// As push(), of what the kernel has worked out.
void ContactField::take(FieldContact &contact, std::size_t q, const PushedBlock &pushed, int lane, ContactArrays &arrays,
                        ContactAccount &account) const
{
  const PushedContact<double> &found = pushed.contact[lane];
  for (int d = 0; d < 3; ++d) contact.cell[d] = pushed.cell[lane][d];
  contact.state = found.state;
  contact.force = found.force;
  contact.moved = found.moved;
  contact.energy = found.energy;

  Row *on = arrays.force();
  near.add_force(q, contact.force, on);
  if (pushed.on_ramp >> lane & 1) near.add_force_at_centre(q, found.at_centre, on);
  arrays.kernels->add_to_nodes(pushed, lane, on);
  count(contact, found.heat, found.damped, account);
}

void ContactField::count(const FieldContact &contact, double heat, double damped, ContactAccount &account) const
{
  account.energy += contact.energy;
  account.stick_energy += contact.state.memory.stick_energy;
  account.heat += heat;
  account.damped += damped;
  account.deepest = std::max(account.deepest, contact.state.memory.depth);
  ++account.touching;
}

// A contact that is over becomes a point to be looked at.
void ContactField::end(const FieldContact &contact, std::size_t q, Fate fate, const ContactArrays &arrays,
                       ContactAccount &account)
{
  account.heat += contact.state.memory.stick_energy;
  if (fate == Fate::LOST) {
    // The last force still did work in half of the last step, as leap-frog counts it.
    account.let_go += contact.energy - 0.5 * dot(contact.force, contact.moved);
    watch[q] = Watch{{-1, -1, -1}, {}, EVERY_SIDE};
    wake[q] = AT_ONCE;
  } else {
    watch[q].cell = {contact.cell[0], contact.cell[1], contact.cell[2]};
    watch[q].X = contact.state.X;
    look(q, arrays, false);
  }
}

void ContactField::add_forces(ContactArrays &arrays, double nearer, double dt, ContactAccount &account)
{
  budget += nearer;
  const bool moves = dt > 0.0;
  if (moves)
    for (std::size_t q = 0; q < wake.size(); ++q)
      if (wake[q] < budget) look(q, arrays, true);
  now.clear();
  for (const std::size_t q : of_contact) now.push_back(point_now(q, arrays));
  std::size_t left = 0;
  for (std::size_t first = 0, end = 0; first < contacts.size(); first = end) {
    const PointKind kind = surface_point(of_contact[first]).kind;
    while (end < contacts.size() && surface_point(of_contact[end]).kind == kind) ++end;
    const PushTask law_of_kind = task(kind, arrays, dt);
    if (moves)
      push_run(first, end, left, law_of_kind, arrays, account);
    else
      for (std::size_t c = first; c < end; ++c) {    // what is known stays as it is
        FieldContact copy = contacts[c];
        copy.state.change = {};
        push(copy, of_contact[c], law_of_kind, now[c], arrays, account);
      }
  }
  if (moves) contacts.resize(left), of_contact.resize(left);
}

// Of contacts from `first` to `end` - 1, those that stay go to the places from `left` on.
void ContactField::push_run(std::size_t first, std::size_t end, std::size_t &left, const PushTask &task, ContactArrays &arrays,
                            ContactAccount &account)
{
  PushedBlock pushed;
  for (std::size_t c = first; c < end; ++c) {
    const std::size_t lane = (c - first) % CONTACT_LANES;
    if (lane == 0 && arrays.kernels)
      arrays.kernels->push(task, &contacts[c], &now[c], static_cast<int>(std::min<std::size_t>(CONTACT_LANES, end - c)), pushed);
    Fate fate = Fate::STAYS;
    if (!arrays.kernels || pushed.hard >> lane & 1)
      fate = push(contacts[c], of_contact[c], task, now[c], arrays, account);
    else
      take(contacts[c], of_contact[c], pushed, static_cast<int>(lane), arrays, account);
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
  return near.bytes() + wake.capacity() * sizeof(double) + watch.capacity() * sizeof(Watch) +
         contacts.capacity() * sizeof(FieldContact) + now.capacity() * sizeof(PointNow) +
         of_contact.capacity() * sizeof(std::size_t);
}

}    // namespace mdanim
