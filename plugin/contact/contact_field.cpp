// SPDX-License-Identifier: GPL-2.0-only
// When points are looked at, and what a contact does in a step.

#include "contact/contact_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mdanim {

static constexpr double LEAST_COSINE = 0.45;    // between the outward normals of the point and of a side that faces it, negated
static constexpr double DEEPEST_BIRTH = 0.5;    // cells
static constexpr double SAME_PLACE = 1e-3;      // cells that X may be off its guess without a second evaluation
static constexpr double LEFT = 1e-9;            // cells that X may stand out of its own
static constexpr double AT_ONCE = -1.0;
static constexpr double NEVER = std::numeric_limits<double>::infinity();
static constexpr double LOST = 0.02;        // cells to go before a point that was not found is looked for again
static constexpr double PRESSED = 0.5;      // cells are taken to be pressed to half at most: motion in space over that in X
static constexpr double RAMPS_END = 2.0;    // cells from an edge from which on all of any point counts
static constexpr double SEARCHED = 5.0;     // cells around a point in which one of the host is looked for
static constexpr double NEAREST = 2.2;      // cells from the middle of a cell on the surface beyond which there is no contact
static constexpr std::uint8_t EVERY_SIDE = 63;

static double component(const Vec3 &a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

static double outside(const Box &box, const Vec3 &x)
{
  double out = -NEVER;
  for (int d = 0; d < 3; ++d) out = std::max({out, box.low(d) - component(x, d), component(x, d) - box.high(d)});
  return out;
}

// --- lists ---

void ContactField::list(ContactObject &points_of, ContactObject &host_now, const ContactArrays &arrays, double reach)
{
  owner = &points_of, host = &host_now;
  host_box = host->box;
  outer.clear(), outer_middle.clear(), outer_grid.clear();
  // A sharp point counts until the centre of its area is a quarter of a cell beyond an edge; the drawn surface of what is no
  // cuboid stands out of its particles.
  const double stands_out = 0.6 * owner->body->spacing() + (host->body->is_cuboid() ? 0.6 : 1.25) * host->body->spacing();

  std::vector<int> points_before(near.size());
  for (std::size_t q = 0; q < near.size(); ++q) points_before[q] = near.point(q);
  const std::vector<Watch> watch_before = std::move(watch);
  near.clear(), wake.clear(), watch.clear(), of_contact.clear();
  budget = 0.0;
  std::size_t before = 0, contact = 0;
  const int points = static_cast<int>(owner->body->points().size());
  for (int p = 0; p < points; ++p) {
    while (contact < contacts.size() && contacts[contact].point < p) ++contact;
    const bool touches = contact < contacts.size() && contacts[contact].point == p;
    while (before < points_before.size() && points_before[before] < p) ++before;
    // Points of a cuboid are a cell apart, too few for what is curved: its own points are dense.
    if (owner->body->points()[p].kind != PointKind::DENSE && !host->body->is_cuboid()) continue;
    if (!near.add(*owner, p)) continue;
    const double out = outside(host_box, near.place(near.size() - 1, arrays.place.data())) - stands_out;
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
  if (of_contact.size() < contacts.size()) {    // of a point whose particles are not there
    std::vector<FieldContact> kept;
    for (const std::size_t q : of_contact)
      kept.push_back(*std::lower_bound(contacts.begin(), contacts.end(), near.point(q),
                                       [](const FieldContact &one, int point) { return one.point < point; }));
    contacts = std::move(kept);
  }
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

// The cell on the host's surface whose middle was nearest when lists were made.
std::array<int, 3> ContactField::nearest_cell(const Vec3 &x, const ContactArrays &arrays)
{
  const ContactBody &body = *host->body;
  if (outer_grid.empty()) {
    for (int k = 0; k < body.count(2); ++k)
      for (int j = 0; j < body.count(1); ++j)
        for (int i = 0; i < body.count(0); ++i) {
          if (!body.is_outer(i, j, k)) continue;
          const int low = host->slot[body.place(i, j, k)], high = host->slot[body.place(i + 1, j + 1, k + 1)];
          if (low < 0 || high < 0) continue;
          outer.push_back({i, j, k});
          outer_middle.push_back(0.5 * (arrays.place[low] + arrays.place[high]));
        }
    outer_grid.emplace_back([this](int n) { return &outer_middle[n].x; }, static_cast<int>(outer.size()),
                            SEARCHED * body.spacing());
  }
  int best = -1;
  double least = NEVER;
  const auto compare = [&](int n) {
    const Vec3 d = outer_middle[n] - x;
    if (dot(d, d) < least || (dot(d, d) == least && n < best)) least = dot(d, d), best = n;
  };
  outer_grid[0].around(&x.x, [&](int slot) { compare(outer_grid[0].order()[slot]); });
  return best < 0 ? std::array<int, 3>{-1, -1, -1} : outer[best];
}

// X of a point at x, the same bits whatever was known of it: the last search begins in the middle of the cell that X lies in.
bool ContactField::find(std::size_t q, const Vec3 &x, const Placed &at, Spot &spot, Vec3 &X)
{
  Watch &known = watch[q];
  const MaterialSearch search(at);
  std::array<int, 3> cell = known.cell;
  X = known.X;
  if (!search.solve(x, cell, X)) return false;
  if (host->body->is_cuboid()) {
    const auto inside = [&](double at_axis, int axis) {
      return std::clamp(static_cast<int>(std::floor(at_axis + LEFT)), 0, host->body->count(axis) - 1);
    };
    cell = {inside(X.x, 0), inside(X.y, 1), inside(X.z, 2)};
  }
  X = {cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5};
  if (!search.solve(x, cell, X, false)) return false;
  known.cell = cell, known.X = X;
  if (is_smooth(surface_point(q))) return search.solve_smooth(x, X) && evaluate(at, smooth(X, *host->body), spot);
  return evaluate(at, trilinear(X, cell), spot);
}

bool ContactField::world_normal(const SurfacePoint &point, const ContactArrays &arrays, Vec3 &normal) const
{
  const Placed own = {*owner->body, owner->slot.data(), arrays.place.data()};
  const std::array<int, 3> cell = {point.cell[0], point.cell[1], point.cell[2]};
  Spot spot;
  if (!evaluate(own, trilinear({cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5}, cell), spot)) return false;
  const ContactBody &body = *owner->body;
  normal = spot.gradient({point.normal.x * body.edge(0), point.normal.y * body.edge(1), point.normal.z * body.edge(2)});
  const double length = std::sqrt(dot(normal, normal));
  if (!(length > 0.0)) return false;
  normal = (1.0 / length) * normal;
  return true;
}

// The ramp near a sharp edge across an axis, in cells: flat points count from one cell inside on, fully from two; others about
// the edge.
double ContactField::ramp_width(const SurfacePoint &point, int axis, double &from) const
{
  const double width = point.kind == PointKind::FLAT ? std::min(1.0, 0.25 * host->body->count(axis)) : 0.5;
  from = point.kind == PointKind::FLAT ? width : -0.25;
  return width;
}

// t(X) over a side, and its gradient by X: the product of ramps about all edges of that side.
double ContactField::part(const SurfacePoint &point, const Vec3 &X, int side, Vec3 &slope) const
{
  slope = {};
  if (!host->body->is_cuboid()) return 1.0;
  double inside = NEVER;    // cells from the nearest edge
  for (int d = 0; d < 3; ++d)
    if (d != side / 2) inside = std::min({inside, component(X, d), host->body->count(d) - component(X, d)});
  if (inside >= RAMPS_END) return 1.0;
  double t[3] = {1.0, 1.0, 1.0}, dt[3] = {0.0, 0.0, 0.0};
  for (int d = 0; d < 3; ++d) {
    if (d == side / 2) continue;
    double from;
    const double width = ramp_width(point, d, from);
    const bool bends = point.kind == PointKind::DENSE;
    const Ramp low(component(X, d), from, width, bends), high(host->body->count(d) - component(X, d), from, width, bends);
    t[d] = low.value * high.value;
    dt[d] = low.slope * high.value - high.slope * low.value;
  }
  slope = {dt[0] * t[1] * t[2], t[0] * dt[1] * t[2], t[0] * t[1] * dt[2]};
  return t[0] * t[1] * t[2];
}

// Whether a contact begins; else when to look again.
bool ContactField::look(std::size_t q, const ContactArrays &arrays, bool may_begin)
{
  Watch &known = watch[q];
  const SurfacePoint &point = surface_point(q);
  const Vec3 x = near.place(q, arrays.place.data());
  const double h = host->body->spacing();
  const Placed at = placed(arrays);
  const auto lost = [&] {
    known.cell = {-1, -1, -1};
    known.open = EVERY_SIDE;
    wake[q] = budget + LOST * h;
    return false;
  };
  if (known.cell[0] < 0) {
    const std::array<int, 3> cell = nearest_cell(x, arrays);
    Spot there;
    const Vec3 middle = {cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5};
    if (cell[0] >= 0 && !evaluate(at, trilinear(middle, cell), there)) return lost();
    const double away = cell[0] < 0 ? 0.5 * SEARCHED * h : std::sqrt(dot(x - there.x, x - there.x));
    if (away > NEAREST * h) {
      known.open = 0;
      wake[q] = budget + away - NEAREST * h;
      return false;
    }
    known.cell = cell, known.X = middle;
  }
  Spot spot;
  Vec3 X, normal;
  if (!find(q, x, at, spot, X) || !world_normal(point, arrays, normal)) return lost();
  const Vec3 X_centre = X + spot.to_material(near.shift(q, arrays.place.data()));

  int side = -1;
  bool is_shut = false;
  double best = NEVER, until = 0.0, slack = NEVER;
  std::uint8_t open = 0;
  Depth of_side[6];
  for (int s = 0; s < host->body->sides(); ++s) {
    of_side[s] = host->body->depth(s, X);
    const double depth = of_side[s].value / h;    // in cells
    const Vec3 inward = spot.gradient(of_side[s].slope);
    const double cosine = dot(normal, inward) / std::sqrt(dot(inward, inward));
    // What must change before the side can begin a contact, in cells: the largest of these three.
    double apart = -depth;
    const double turned = PRESSED * (LEAST_COSINE - cosine);
    if (host->body->is_cuboid())
      for (int d = 0; d < 3; ++d) {
        if (d == s / 2) continue;
        double from;
        ramp_width(point, d, from);
        apart = std::max(apart, from - std::min(component(X_centre, d), host->body->count(d) - component(X_centre, d)));
      }
    if (apart <= 0.0 || turned > apart) open |= static_cast<std::uint8_t>(1u << s);
    slack = std::min(slack, PRESSED * h * std::max({apart, turned, depth - DEEPEST_BIRTH}));
    if (cosine < LEAST_COSINE) continue;
    if (depth <= 0.0) {
      is_shut = true;
      until = std::max(until, std::min(-PRESSED * depth * h, 0.5 * PRESSED * h * (cosine - LEAST_COSINE)));
    } else if (depth / cosine < best) {
      best = depth / cosine, side = s;
    }
  }
  if (is_shut) slack = std::max(slack, until);
  const std::uint8_t was_open = known.open;
  known.open = open;
  Vec3 slope;
  if (is_shut || side < 0 || of_side[side].value > DEEPEST_BIRTH * h || part(point, X_centre, side, slope) <= 0.0 || !may_begin) {
    wake[q] = budget + std::max(0.0, slack);
    return false;
  }

  FieldContact contact{};
  contact.point = near.point(q);
  contact.side = side;
  for (int d = 0; d < 3; ++d) contact.cell[d] = known.cell[d];
  contact.X = contact.anchor = X;
  contact.memory.depth = of_side[side].value;
  contact.memory.offset = was_open >> side & 1 ? of_side[side].value : 0.0;
  const auto where = std::lower_bound(of_contact.begin(), of_contact.end(), q);
  contacts.insert(contacts.begin() + (where - of_contact.begin()), contact);
  of_contact.insert(where, q);
  wake[q] = NEVER;
  return true;
}

// --- contacts ---

// X of the point is that of the weights plus `off`, about which everything is linear. False when it cannot be found.
bool ContactField::follow(FieldContact &contact, const SurfacePoint &point, const Vec3 &x, const Placed &at, Weights &weights,
                          Spot &spot, Vec3 &off) const
{
  constexpr int MOST = 12;
  const MaterialSearch search(at);
  const bool is_smooth_one = is_smooth(point);
  std::array<int, 3> cell = {contact.cell[0], contact.cell[1], contact.cell[2]};
  Vec3 X = contact.X + contact.change;
  bool again = true;
  for (int step = 0; again; ++step) {
    if (step == MOST) return false;
    again = false;
    weights = is_smooth_one ? smooth(X, *host->body) : trilinear(X, cell);
    if (!evaluate(at, weights, spot)) return false;
    if (search.is_collapsed(spot)) {    // from the last place, then from the cells around
      if (is_smooth_one) return false;
      Vec3 from = contact.X;
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
    } else if (!is_smooth_one && search.step_to_neighbour(cell, X + off, LEFT)) {
      X += off;
      again = true;
    }
  }
  for (int d = 0; d < 3; ++d) contact.cell[d] = cell[d];
  X += off;
  contact.change = X - contact.X;
  contact.X = X;
  return true;
}

ContactField::Fate ContactField::push(FieldContact &contact, std::size_t q, ContactArrays &arrays, double dt,
                                      ContactAccount &account)
{
  const SurfacePoint &point = surface_point(q);
  const Vec3 *place = arrays.place.data();
  const Placed at = placed(arrays);
  const Vec3 x = near.place(q, place);
  Weights weights;
  Spot spot;
  Vec3 off;
  if (!follow(contact, point, x, at, weights, spot, off)) return Fate::LOST;
  const Vec3 shift = spot.to_material(near.shift(q, place));
  const Depth below = host->body->depth(contact.side, contact.X);
  Vec3 part_slope;
  const double t = part(point, contact.X + shift, contact.side, part_slope);
  const double longest = 2.0 * host->body->spacing() +
                         std::max({host->body->count(0) * host->body->edge(0), host->body->count(1) * host->body->edge(1),
                                   host->body->count(2) * host->body->edge(2)});
  if (below.value <= 0.0 || t <= 0.0 || below.value > longest) {
    if (dt > 0.0) account.damped += last_damping_work(contact.memory, below.value);
    return Fate::OUT;
  }

  const Vec3 normal = spot.gradient(below.slope);    // of the depth, in space
  ContactForce force = contact_pressure(law, point.area, t, below.value, dt, contact.memory);
  Vec3 lean;
  if (law.friction > 0.0) {
    // At the same depth as the point.
    lean = contact.anchor - contact.X;
    lean -= (dot(lean, below.slope) / dot(below.slope, below.slope)) * below.slope;
    contact_friction(law, point.area, t, -1.0 * spot.to_space(lean), normal, dt, contact.memory, force);
    lean = force.kept * lean;
    contact.anchor = contact.X + lean;
  }
  const Vec3 on_point = -force.press * normal + force.pull + force.drag;
  const Vec3 at_centre = -force.surface_energy * spot.gradient(part_slope);
  Vec3 *on = arrays.force.data();
  near.add_force(q, on_point, on);
  if (part_slope.x != 0.0 || part_slope.y != 0.0 || part_slope.z != 0.0) near.add_force_at_centre(q, at_centre, on);
  const Vec3 both = on_point + at_centre;
  const auto moment = [&](int d) {
    return component(off, d) * both + component(shift, d) * at_centre + component(lean, d) * force.pull;
  };
  spread(at, weights, -1.0 * both, {-1.0 * moment(0), -1.0 * moment(1), -1.0 * moment(2)}, on);

  contact.force = on_point;
  contact.moved = spot.to_space(contact.change);
  contact.energy = t * force.surface_energy;
  account.energy += contact.energy;
  account.stick_energy += contact.memory.stick_energy;
  account.heat += force.heat;
  account.damped += force.damped;
  account.deepest = std::max(account.deepest, below.value);
  ++account.touching;
  return Fate::STAYS;
}

// A contact that is over becomes a point to be looked at.
void ContactField::end(const FieldContact &contact, std::size_t q, Fate fate, const ContactArrays &arrays,
                       ContactAccount &account)
{
  account.heat += contact.memory.stick_energy;
  if (fate == Fate::LOST) {
    // The last force still did work in half of the last step, as leap-frog counts it.
    account.let_go += contact.energy - 0.5 * dot(contact.force, contact.moved);
    watch[q] = Watch{{-1, -1, -1}, {}, EVERY_SIDE};
    wake[q] = AT_ONCE;
  } else {
    watch[q].cell = {contact.cell[0], contact.cell[1], contact.cell[2]};
    watch[q].X = contact.X;
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
  std::size_t left = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (!moves) {    // what is known stays as it is
      FieldContact copy = contacts[c];
      copy.change = {};
      push(copy, of_contact[c], arrays, dt, account);
      continue;
    }
    const Fate fate = push(contacts[c], of_contact[c], arrays, dt, account);
    if (fate != Fate::STAYS) {
      end(contacts[c], of_contact[c], fate, arrays, account);
      continue;
    }
    if (left < c) contacts[left] = contacts[c], of_contact[left] = of_contact[c];
    ++left;
  }
  if (moves) contacts.resize(left), of_contact.resize(left);
}

std::size_t ContactField::bytes() const
{
  return near.bytes() + wake.capacity() * sizeof(double) + watch.capacity() * sizeof(Watch) +
         contacts.capacity() * sizeof(FieldContact) + of_contact.capacity() * sizeof(std::size_t) +
         outer.capacity() * (sizeof(outer[0]) + sizeof(Vec3));
}

}    // namespace mdanim
