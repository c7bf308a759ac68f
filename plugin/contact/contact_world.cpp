// SPDX-License-Identifier: GPL-2.0-only
// Finds objects near each other, and fixes the order of all sums: pairs by ascending ids, within each the points of the lower one
// first; then planes.

#include "contact/contact_world.h"

#include "threads/waiting.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

namespace mdanim {

static constexpr double AROUND = 3.0;            // spacings around a contact within which particles may take part in it
static constexpr double CARRIED = 2.25;          // spacings that a particle may be from a point of its cells
static constexpr double AT_A_PLANE = 0.75;       // of the skin: 1/2 for particles, and half of that for points outside of cells
static constexpr double BETWEEN_POINTS = 0.6;    // spacings by which a round surface may extend beyond its points
static constexpr double MOST_SKINS = 32.0;
// Costs of making lists, and of moving a particle; approximate.
static constexpr double NS_OF_OBJECT = 5e3, NS_OF_FIELD = 5e3, NS_OF_PARTICLE = 8.0;
static constexpr int FIELD_COST = 20;    // cost of a field without points

// --- lists ---

bool ContactWorld::near_plane(const Box &box, const ContactPlane &plane, double gap) const
{
  const double distance = plane.sign > 0 ? box.low(plane.axis) - plane.at : plane.at - box.high(plane.axis);
  return !box.empty() && distance <= gap;
}

// How far apart the particles of two objects may be that may touch before lists are made again.
double ContactWorld::range(int a, int b) const
{
  const ContactBody &one = *all[a].body, &other = *all[b].body;
  return skin + std::max(ContactField::stands_out(one, other), ContactField::stands_out(other, one));
}

void ContactWorld::look_ahead(const std::vector<Box> &boxes, double now)
{
  skin = now;
  const auto pairs_within = [&](double gap) {
    std::vector<std::pair<int, int>> found;
    if (settings.objects)
      for (const auto &[a, b] : meeting_pairs(boxes, gap))
        if (can_touch(a, b)) found.emplace_back(a, b);
    return found;
  };
  const auto planes_within = [&](double gap) {
    std::vector<std::pair<int, int>> found;
    for (int n = 0; n < objects(); ++n)
      for (std::size_t p = 0; p < settings.planes.size(); ++p)
        if (movable[n] && near_plane(boxes[n], settings.planes[p], gap + ContactField::STRETCHED * all[n].body->overhang()))
          found.emplace_back(n, static_cast<int>(p));
    return found;
  };
  near_pairs.clear();
  for (const auto &[a, b] : pairs_within(skin + widest)) {
    Vec3 way;    // between the middles of their boxes
    for (int d = 0; d < 3; ++d)
      (d == 0 ? way.x : d == 1 ? way.y : way.z) = boxes[b].low(d) + boxes[b].high(d) - boxes[a].low(d) - boxes[a].high(d);
    const double length = std::sqrt(dot(way, way));
    if (length > 0.0) way = (1.0 / length) * way;
    near_pairs.push_back({a, b, {boxes[a], -1.0 * way}, {boxes[b], way}});
  }
  near_planes = planes_within(skin);
  apart = 0.0;
  for (double skins = 1.0; is_idle() && skins <= MOST_SKINS; skins *= 2.0) {
    if (!pairs_within(skin + widest + skins * skin).empty() || !planes_within(skin + skins * skin).empty()) break;
    apart = 0.5 * (1.0 + skins) * skin;
  }
  find_sights();
}

void ContactWorld::find_sights()
{
  sights.assign(all.size(), {});
  for (std::size_t k = 0; k < near_pairs.size(); ++k) {
    const NearPair &pair = near_pairs[k];
    const ContactBody &one = *all[pair.a].body, &other = *all[pair.b].body;
    const double around = skin + AROUND * std::max(one.spacing(), other.spacing()) +
                          ContactField::STRETCHED * std::max(one.overhang(), other.overhang());
    sights[pair.a].push_back({pair.of_b.grown(around), static_cast<int>(2 * k + 1)});
    sights[pair.b].push_back({pair.of_a.grown(around), static_cast<int>(2 * k)});
  }
  for (const auto &[n, p] : near_planes) {
    const ContactBody &body = *all[n].body;
    sights[n].push_back({settings.planes[p].within(AT_A_PLANE * skin + CARRIED * body.spacing() + body.overhang()), -1});
  }
}

void ContactWorld::see(int object, const Vec3 &x, std::vector<double> &ends) const
{
  for (const Sight &sight : sights[object])
    if (sight.end >= 0 && sight.zone.contains(x)) {
      double &own = ends[sight.end ^ 1];
      own = std::min(own, -dot(sight.zone.across, x));
    }
}

void ContactWorld::narrow(const std::vector<double> &ends)
{
  std::vector<NearPair> left;
  for (std::size_t k = 0; k < near_pairs.size(); ++k) {
    NearPair &pair = near_pairs[k];
    pair.of_a.from = ends[2 * k], pair.of_b.from = ends[2 * k + 1];
    if (pair.of_a.from + pair.of_b.from <= range(pair.a, pair.b)) left.push_back(pair);
  }
  near_pairs = std::move(left);
  find_sights();
}

bool ContactWorld::needs(const ContactParticle &particle, const Vec3 &x) const
{
  const ContactBody &body = *all[particle.object].body;
  const bool is_carrier = particle.node < 0 || particle.node >= body.particles() || body.carries(particle.node);
  return std::any_of(sights[particle.object].begin(), sights[particle.object].end(),
                     [&](const Sight &sight) { return (is_carrier || sight.end >= 0) && sight.zone.contains(x); });
}

void ContactWorld::forget()
{
  for (auto &[key, both] : fields) both.lower.forget(), both.higher.forget();
  for (auto &[key, field] : plane_fields) field.forget();
}

static Vec3 place(const Coordinates &places, std::size_t slot) { return {places[0][slot], places[1][slot], places[2][slot]}; }

namespace {

// The largest displacement of any of many particles relative to `way`, the displacement of the first. The displacement half-way
// between the first and the last would give fewer looks, but then parts of a crowd had other bits than the whole: a look came too
// late.
struct Deviation {
  Vec3 way;
  double square = 0.0;

  void include(const Vec3 &change)
  {
    const Vec3 off = change - way;
    square = std::max(square, dot(off, off));
  }
  void tell(ContactObject &one) const { one.way = way, one.stir = one.body->leverage() * std::sqrt(square); }
};

// Upper bound of how much two objects have come nearer.
double nearer(const ContactObject &a, const ContactObject &b)
{
  const Vec3 together = a.way - b.way;
  return std::sqrt(dot(together, together)) + a.stir + b.stir;
}

}    // namespace

void ContactWorld::clear_forces(ContactObject &one)
{
  if (one.is_pushed) arrays.clear_forces(one.first_slot, one.last_slot);
  one.is_pushed = false;
}

void ContactWorld::list(const std::vector<ContactParticle> &particles, const Coordinates &places)
{
  for (ContactObject &one : all) clear_forces(one);
  arrays.renew(particles.size());
  for (std::size_t slot = 0; slot < particles.size(); ++slot) arrays.place()[slot].value = place(places, slot);
  std::size_t from = 0;
  std::vector<Vec3> changes;
  for (int n = 0; n < objects(); ++n) {
    ContactObject &one = all[n];
    const std::vector<int> slot_before = std::move(one.slot);
    one.outer = std::make_shared<LateOuterCells>();
    one.slot.assign(sights[n].empty() ? 0 : one.body->places(), -1);
    one.first_slot = static_cast<int>(from);
    changes.clear();    // since the last step, of objects that already existed
    for (; from < particles.size() && particles[from].object == n; ++from) {
      const int at = one.body->place_of(particles[from].node);
      one.slot[at] = static_cast<int>(from);
      if (!slot_before.empty() && slot_before[at] >= 0)
        changes.push_back(arrays.place()[from].value - arrays.place_before()[slot_before[at]].value);
    }
    one.last_slot = static_cast<int>(from);
    Deviation motion{changes.empty() ? Vec3{} : changes.front()};
    for (const Vec3 &change : changes) motion.include(change);
    motion.tell(one);
  }

  active.clear();
  std::map<PairKey, Both> kept;
  for (const NearPair &pair : near_pairs) {
    const PairKey key{all[pair.a].id, all[pair.b].id};
    const auto old = fields.find(key);
    Both &both = kept.emplace(key, old == fields.end() ? new_pair(pair.a, pair.b) : std::move(old->second)).first->second;
    active.push_back({pair.a, pair.b, &both.lower, nullptr, &pair.of_b, false, {}});
    active.push_back({pair.b, pair.a, &both.higher, nullptr, &pair.of_a, false, {}});
  }
  fields = std::move(kept);
  std::map<std::pair<int, int>, PlaneField> kept_planes;
  for (const auto &[n, p] : near_planes) {
    const std::pair<int, int> key{all[n].id, p};
    const auto old = plane_fields.find(key);
    PlaneField &field =
        kept_planes.emplace(key, old == plane_fields.end() ? new_plane(n, p) : std::move(old->second)).first->second;
    active.push_back({n, n, nullptr, &field, nullptr, false, {}});
  }
  plane_fields = std::move(kept_planes);
  find_points();
  listed = true;
}

// Lists the points of all fields that may touch. Objects and fields do not depend on each other here.
void ContactWorld::find_points()
{
  std::vector<std::optional<PointFinder>> finder(all.size());
  threads.parts(objects(), NS_OF_OBJECT, [&](long first, long end) {
    for (long n = first; n < end; ++n)
      if (!sights[n].empty()) finder[n].emplace(all[n], arrays);
  });
  threads.parts(static_cast<long>(active.size()), NS_OF_FIELD, [&](long first, long end) {
    for (long k = first; k < end; ++k) {
      const Active &one = active[k];
      ContactObject &owner = all[one.a], &host = all[one.b];
      const PointFinder &points = *finder[one.a];
      if (one.plane) {
        one.plane->list(owner, points, arrays, AT_A_PLANE * skin);
        continue;
      }
      const double out = ContactField::stands_out(*owner.body, *host.body);
      Zone zone = one.of_host->grown(out);
      zone.from =
          finder[one.b]->least_along(zone.across) - (host.body->is_cuboid() ? out : BETWEEN_POINTS * host.body->spacing());
      one.field->list(owner, host, points, zone, arrays, skin, nearer(owner, host));
    }
  });
  costs.assign(1, 0);
  for (const Active &one : active)
    costs.push_back(costs.back() + FIELD_COST + (one.plane ? one.plane->cost() : one.field->cost()));
}

// --- steps ---

void ContactWorld::move_to(const Coordinates &places)
{
  threads.parts(static_cast<long>(arrays.size()), NS_OF_PARTICLE, [&](long from, long to) {
    for (ContactObject &one : all) {
      if (one.first_slot == one.last_slot || one.first_slot < from || one.first_slot >= to) continue;
      Deviation motion{place(places, one.first_slot) - arrays.place()[one.first_slot].value};
      for (int s = one.first_slot; s < one.last_slot; ++s) {
        const Vec3 x = place(places, s);
        motion.include(x - arrays.place()[s].value);
        arrays.place()[s].value = x;
      }
      motion.tell(one);
      clear_forces(one);
    }
  });
}

void ContactWorld::step(const Coordinates &places, double dt)
{
  account.begin_step();
  if (arrays.size() == 0) return;
  move_to(places);
  const bool ahead = dt > 0.0 && threads.pays(static_cast<double>(costs.back()));
  if (ahead) {
    look_and_work_ahead(dt);
    add_forces_side_by_side(dt);
  } else {
    for (Active &one : active) {
      look(one, dt);
      one.has_something = true;
      add_forces(one, dt);
    }
  }
  for (const Active &one : active)
    if (one.has_something) account.add(one.of_step);
}

void ContactWorld::look(Active &one, double dt)
{
  if (one.plane) {
    if (dt == 0.0) one.plane->settle(arrays);
    one.plane->look(arrays, dt);
  } else {
    if (dt == 0.0) one.field->settle(arrays);
    one.field->look(arrays, nearer(all[one.a], all[one.b]), dt);
  }
}

// The work that fields do independently. Their contributions to shared particles and sums are added afterwards, in one order.
void ContactWorld::look_and_work_ahead(double dt)
{
  threads.parts(costs.back(), 1.0, [&](long from, long to) {    // costs are in ns, approximately
    const auto number = [&](long cost) { return std::lower_bound(costs.begin(), costs.end() - 1, cost) - costs.begin(); };
    for (long k = number(from), end = number(to); k < end; ++k) {
      Active &one = active[k];
      look(one, dt);
      one.plane ? one.plane->work_ahead(arrays, dt) : one.field->work_ahead(arrays, dt);
      one.has_something = one.plane ? !one.plane->touching().empty() : one.field->has_something();
    }
  });
}

void ContactWorld::add_forces(Active &one, double dt)
{
  ContactObject &a = all[one.a], &b = all[one.b];
  one.of_step = {};
  if (one.plane) {
    one.plane->add_forces(arrays, dt, one.of_step);
    a.is_pushed |= !one.plane->touching().empty();
    return;
  }
  one.field->add_forces(arrays, dt, one.of_step);
  if (!one.field->is_idle()) a.is_pushed = b.is_pushed = true;
}

// On each object fields are added in the order of sums. First come those that wait for none, then those that wait for one of
// them, and so on.
void ContactWorld::list_turns()
{
  std::vector<int> before(all.size(), 0), longest(all.size(), 0);    // number of fields so far, and the longest chain of them
  for (auto &some : turns_after) some.clear();
  for (Active &one : active) {
    if (!one.has_something) continue;
    const int chain = std::max(longest[one.a], longest[one.b]);
    if (static_cast<std::size_t>(chain) == turns_after.size()) turns_after.emplace_back();
    turns_after[chain].push_back({&one, before[one.a], before[one.b]});
    ++before[one.a];
    if (one.b != one.a) ++before[one.b];
    longest[one.a] = longest[one.b] = chain + 1;
  }
  turns.clear();
  for (const auto &some : turns_after) turns.insert(turns.end(), some.begin(), some.end());
}

// Threads take fields in that order, so a thread waits only for a field that another thread is working on.
void ContactWorld::add_forces_side_by_side(double dt)
{
  constexpr double PART = 0.3;    // of the cost
  list_turns();
  std::vector<std::atomic<int>> added(all.size());
  std::atomic<std::size_t> next{0};
  threads.each(threads.many(), PART * static_cast<double>(costs.back()), [&](int) {
    for (std::size_t n = next++; n < turns.size(); n = next++) {
      const Turn &turn = turns[n];
      Active &one = *turn.field;
      wait_until([&] {
        return added[one.a].load(std::memory_order_acquire) == turn.on_a &&
               added[one.b].load(std::memory_order_acquire) == turn.on_b;
      });
      add_forces(one, dt);
      added[one.a].store(turn.on_a + 1, std::memory_order_release);
      if (one.b != one.a) added[one.b].store(turn.on_b + 1, std::memory_order_release);
    }
  });
}

Vec3 ContactWorld::force_on_planes() const
{
  Vec3 sum;
  for (const auto &[key, field] : plane_fields) sum += field.force_on_plane();
  return sum;
}

// --- state ---

ContactWorld::PairContacts ContactWorld::pair_contacts() const
{
  PairContacts found;
  for (const auto &[key, both] : fields)
    if (!both.lower.is_idle() || !both.higher.is_idle()) found[key] = {both.lower.touching(), both.higher.touching()};
  return found;
}

ContactWorld::PlaneContacts ContactWorld::plane_contacts() const
{
  PlaneContacts found;
  for (const auto &[key, field] : plane_fields)
    if (!field.touching().empty()) {
      auto &rows = found[key.first];
      rows.insert(rows.end(), field.touching().begin(), field.touching().end());
    }
  return found;
}

void ContactWorld::restore(const PairContacts &pairs, const PlaneContacts &planes)
{
  listed = false;
  active.clear(), costs.assign(1, 0);
  fields.clear();
  plane_fields.clear();
  for (const auto &[key, contacts] : pairs) {
    Both both = new_pair(number_of.at(key.first), number_of.at(key.second));
    both.lower.restore(contacts.first);
    both.higher.restore(contacts.second);
    fields.emplace(key, std::move(both));
  }
  for (const auto &[id, contacts] : planes) {
    for (int p = 0; p < static_cast<int>(settings.planes.size()); ++p) {
      std::vector<PlaneContact> mine;
      for (const PlaneContact &contact : contacts)
        if (contact.plane == p) mine.push_back(contact);
      if (mine.empty()) continue;
      PlaneField field = new_plane(number_of.at(id), p);
      field.restore(std::move(mine));
      plane_fields.emplace(std::pair<int, int>{id, p}, std::move(field));
    }
  }
}

std::size_t ContactWorld::bytes_of_fields() const
{
  std::size_t sum = 0;
  for (const auto &[key, both] : fields) sum += sizeof both + both.lower.bytes() + both.higher.bytes();
  for (const auto &[key, field] : plane_fields) sum += sizeof field + field.bytes();
  return sum;
}

std::size_t ContactWorld::bytes_of_particles() const
{
  std::size_t sum = arrays.bytes();
  for (const ContactObject &one : all)
    sum += sizeof one + one.slot.capacity() * sizeof(int) + (one.outer ? one.outer->bytes() : 0);
  return sum;
}

}    // namespace mdanim
