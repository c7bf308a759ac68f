// SPDX-License-Identifier: GPL-2.0-only
// Which objects are near each other, and the order of all sums: pairs by ascending ids, of each the points of the lower one
// first; then planes.

#include "contact/contact_world.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace mdanim {

static constexpr double STANDS_OUT = 2.5;    // spacings by which two drawn surfaces may stand out of their particles
static constexpr double AROUND = 3.0;        // spacings around a contact in which particles may have a part in it
static constexpr double MOST_SKINS = 32.0;
static constexpr double ONSET = 0.05;    // eps over the spacing
static constexpr double ALONE = 2.0;     // stiffness where only the dense points of one act, over that of points of both

void ContactWorld::take(std::vector<ContactObject> now, std::vector<char> moves)
{
  all = std::move(now);
  movable = std::move(moves);
  number_of.clear();
  spacing = 0.0;
  for (std::size_t n = 0; n < all.size(); ++n) {
    number_of[all[n].id] = static_cast<int>(n);
    spacing = std::max(spacing, all[n].body->spacing());
  }
}

// --- laws ---

ContactLaw ContactWorld::law(const ContactObject &owner, double kappa, double friction, double damping) const
{
  const double h = owner.body->spacing();
  return {kappa, ONSET * h, friction, damping > 0.0 ? 2.0 * damping * std::sqrt(0.5 * kappa * owner.density * h) / kappa : 0.0};
}

ContactWorld::Both ContactWorld::new_pair(int a, int b)
{
  ContactObject &lower = all[a], &higher = all[b];
  const double h = std::max(lower.body->spacing(), higher.body->spacing());
  const bool both = lower.body->is_cuboid() == higher.body->is_cuboid();
  const double kappa =
      (both ? 1.0 : ALONE) * settings.stiffness * 2.0 * lower.young * higher.young / (lower.young + higher.young) / h;
  double friction = std::sqrt(lower.friction * higher.friction), damping = friction > 0.0 ? settings.damping : 0.0;
  if (const auto own = settings.pairs.find({lower.id, higher.id}); own != settings.pairs.end())
    friction = own->second.friction, damping = own->second.damping;
  return {{lower, higher, law(lower, kappa, friction, damping)}, {higher, lower, law(higher, kappa, friction, damping)}};
}

PlaneField ContactWorld::new_plane(int n, int plane)
{
  ContactObject &one = all[n];
  const double kappa = (one.body->is_cuboid() ? 1.0 : ALONE) * settings.stiffness * one.young / one.body->spacing();
  return {one, plane, settings.planes[plane], law(one, kappa, one.friction, one.friction > 0.0 ? settings.damping : 0.0)};
}

// --- lists ---

bool ContactWorld::near_plane(const Box &box, const ContactPlane &plane, double gap) const
{
  const double distance = plane.sign > 0 ? box.low(plane.axis) - plane.at : plane.at - box.high(plane.axis);
  return !box.empty() && distance <= gap;
}

void ContactWorld::look_ahead(const std::vector<Box> &boxes, double now)
{
  skin = now;
  for (std::size_t n = 0; n < all.size(); ++n) all[n].box = boxes[n];
  const double range = skin + STANDS_OUT * spacing;
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
        if (movable[n] && near_plane(boxes[n], settings.planes[p], gap)) found.emplace_back(n, static_cast<int>(p));
    return found;
  };
  near_pairs = pairs_within(range);
  near_planes = planes_within(range);
  apart = 0.0;
  for (double skins = 1.0; is_idle() && skins <= MOST_SKINS; skins *= 2.0) {
    if (!pairs_within(range + skins * skin).empty() || !planes_within(range + skins * skin).empty()) break;
    apart = 0.5 * (1.0 + skins) * skin;
  }

  zones.assign(all.size(), {});
  // Points of what is no cuboid stand out of its box.
  const bool cuboids = std::all_of(all.begin(), all.end(), [](const ContactObject &one) { return one.body->is_cuboid(); });
  const double around = skin + (AROUND + (cuboids ? 0.0 : 0.5 * STANDS_OUT)) * spacing;
  for (const auto &[a, b] : near_pairs) {
    zones[a].push_back(boxes[b].grown(around));
    zones[b].push_back(boxes[a].grown(around));
  }
  for (const auto &[n, p] : near_planes) {
    const ContactPlane &plane = settings.planes[p];
    Box zone = boxes[n].grown(around);
    // All on the plane's other side, and what is near it.
    (plane.sign > 0 ? zone.bound[3 + plane.axis] : zone.bound[plane.axis]) = -plane.sign * plane.at - around;
    zones[n].push_back(zone);
  }
}

bool ContactWorld::needs(int object, const double *x) const
{
  return std::any_of(zones[object].begin(), zones[object].end(), [x](const Box &zone) { return zone.contains(x); });
}

void ContactWorld::forget()
{
  for (auto &[key, both] : fields) both.lower.forget(), both.higher.forget();
  for (auto &[key, field] : plane_fields) field.forget();
}

static Vec3 place(const Coordinates &places, std::size_t slot) { return {places[0][slot], places[1][slot], places[2][slot]}; }

void ContactWorld::list(const std::vector<ContactParticle> &particles, const Coordinates &places)
{
  arrays.resize(particles.size());
  for (std::size_t slot = 0; slot < particles.size(); ++slot) arrays.place()[slot].value = place(places, slot);
  std::size_t from = 0;
  for (int n = 0; n < objects(); ++n) {
    ContactObject &one = all[n];
    one.outer.reset();
    if (zones[n].empty()) {
      one.slot.clear();
      one.slot.shrink_to_fit();
      one.first_slot = one.last_slot = static_cast<int>(from);
      continue;
    }
    one.slot.assign(one.body->places(), -1);
    one.first_slot = static_cast<int>(from);
    for (; from < particles.size() && particles[from].object == n; ++from)
      one.slot[one.body->place_of(particles[from].node)] = static_cast<int>(from);
    one.last_slot = static_cast<int>(from);
  }

  std::vector<std::optional<PointFinder>> finders(all.size());
  const auto finder = [&](int n) -> const PointFinder & { return finders[n] ? *finders[n] : finders[n].emplace(all[n], arrays); };
  std::map<PairKey, Both> kept;
  for (const auto &[a, b] : near_pairs) {
    const PairKey key{all[a].id, all[b].id};
    const auto old = fields.find(key);
    Both &both = kept.emplace(key, old == fields.end() ? new_pair(a, b) : std::move(old->second)).first->second;
    both.lower.list(all[a], all[b], finder(a), arrays, skin);
    both.higher.list(all[b], all[a], finder(b), arrays, skin);
  }
  fields = std::move(kept);
  std::map<std::pair<int, int>, PlaneField> kept_planes;
  for (const auto &[n, p] : near_planes) {
    const std::pair<int, int> key{all[n].id, p};
    const auto old = plane_fields.find(key);
    PlaneField &field =
        kept_planes.emplace(key, old == plane_fields.end() ? new_plane(n, p) : std::move(old->second)).first->second;
    field.list(all[n], arrays, skin);
  }
  plane_fields = std::move(kept_planes);
}

// --- steps ---

void ContactWorld::move_to(const Coordinates &places)
{
  for (ContactObject &one : all) {
    one.stir = 0.0;
    one.way = {};
    if (one.first_slot == one.last_slot) continue;
    one.way = place(places, one.first_slot) - arrays.place()[one.first_slot].value;
    double most = 0.0;
    for (int s = one.first_slot; s < one.last_slot; ++s) {
      const Vec3 x = place(places, s), off = (x - arrays.place()[s].value) - one.way;
      most = std::max(most, dot(off, off));
      arrays.place()[s].value = x;
    }
    one.stir = std::sqrt(most);
  }
}

void ContactWorld::step(const Coordinates &places, double dt)
{
  account.begin_step();
  if (arrays.size() == 0) return;
  move_to(places);
  arrays.clear_forces();
  for (auto &[key, both] : fields) {
    const ContactObject &a = all[number_of[key.first]], &b = all[number_of[key.second]];
    const Vec3 together = a.way - b.way;
    const double nearer = std::sqrt(dot(together, together)) + a.stir + b.stir;
    for (ContactField *field : {&both.lower, &both.higher}) {
      if (dt == 0.0) field->settle(arrays);
      field->add_forces(arrays, nearer, dt, account);
    }
  }
  for (auto &[key, field] : plane_fields) {
    const ContactObject &one = all[number_of[key.first]];
    if (dt == 0.0) field.settle(arrays);
    field.add_forces(arrays, std::sqrt(dot(one.way, one.way)) + one.stir, dt, account);
  }
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

std::size_t ContactWorld::bytes() const
{
  std::size_t sum = arrays.bytes();
  for (const ContactObject &one : all)
    sum += sizeof one + one.slot.capacity() * sizeof(int) + (one.outer ? one.outer->bytes() : 0);
  for (const auto &[key, both] : fields) sum += sizeof both + both.lower.bytes() + both.higher.bytes();
  for (const auto &[key, field] : plane_fields) sum += sizeof field + field.bytes();
  return sum;
}

}    // namespace mdanim
