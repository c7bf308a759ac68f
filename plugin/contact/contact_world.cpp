// SPDX-License-Identifier: GPL-2.0-only
// Objects and their particles, the fields between them, and the order of these.

#include "contact/contact_world.h"

#include "contact/lattice_field.h"
#include "contact/mean_motion.h"
#include "contact/plane_field.h"
#include "contact/rigid_field.h"
#include "simd/kernels.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>

namespace mdanim {

// Costs of making lists, and of moving a particle; approximate.
static constexpr double NS_OF_OBJECT = 5e3, NS_OF_FIELD = 5e3, NS_OF_PARTICLE = 8.0;

// --- objects ---

static void clear_forces(ContactObject &one, ContactArrays &arrays)
{
  if (one.is_pushed) arrays.clear_forces(one.first_slot, one.last_slot);
  one.is_pushed = false;
}

void ContactWorld::drop_lists()
{
  listed = false;
  sums.clear();
}

void ContactWorld::take(std::vector<ContactObject> now, std::vector<char> moves)
{
  for (ContactObject &one : all) clear_forces(one, arrays);    // the new objects have no forces yet
  drop_lists();
  std::set<int> same;
  for (const ContactObject &one : now)
    if (const ContactObject *before = with_id(one.id); before && one.has_points_of(*before)) same.insert(one.id);
  for (auto field = fields.begin(); field != fields.end();) {
    const FieldKey &key = field->first;
    field = same.count(key.first) && (key.at_plane || same.count(key.second)) ? std::next(field) : fields.erase(field);
  }
  all = std::move(now);
  movable = std::move(moves);
  number_of.clear();
  for (int n = 0; n < objects(); ++n) number_of[all[n].id] = n, all[n].takes_force = movable[n];
  for (auto &[key, field] : fields) field->use(law_of(key));    // materials may have changed since contacts began
}

const ContactObject *ContactWorld::with_id(int id) const
{
  const auto found = number_of.find(id);
  return found == number_of.end() ? nullptr : &all[found->second];
}

const ContactObject *ContactWorld::misfit(const std::vector<ContactObject> &now) const
{
  std::set<int> in_touch;
  for (const auto &[key, field] : fields)
    if (!field->is_idle()) {
      in_touch.insert(key.first);
      if (!key.at_plane) in_touch.insert(key.second);
    }
  for (const ContactObject &one : now)
    if (const ContactObject *before = with_id(one.id); before && in_touch.count(one.id) && !one.has_points_of(*before))
      return &one;
  return nullptr;
}

// --- fields ---

ContactLaw ContactWorld::law_of(const FieldKey &key) const
{
  const int a = owner_of(key), b = host_of(key);
  if (key.at_plane) return settings.law_at_plane(all[a]);
  const double of_owner = all[a].density, of_host = all[b].density;
  const double density = !movable[a] ? of_host : !movable[b] ? of_owner : std::min(of_owner, of_host);
  return settings.law_of_pair(all[a], all[b], density);
}

std::unique_ptr<ContactField> ContactWorld::make(const FieldKey &key)
{
  ContactObject &owner = all[owner_of(key)];
  if (key.at_plane) return std::make_unique<PlaneField>(owner, key.second, settings.planes[key.second], law_of(key), losses[key]);
  ContactObject &host = all[host_of(key)];
  if (host.is_rigid()) return std::make_unique<RigidField>(owner, host, law_of(key));
  return std::make_unique<LatticeField>(owner, host, law_of(key));
}

void ContactWorld::list_fields()
{
  sums.clear();
  Fields kept;
  const auto keep = [&](const FieldKey &key, const Zone *host_zone) {
    Fields::node_type old = fields.extract(key);
    const auto now = old ? kept.insert(kept.end(), std::move(old)) : kept.emplace_hint(kept.end(), key, make(key));
    sums.add(owner_of(key), host_of(key), now->second.get(), host_zone);
  };
  for (const NearObjects::NearPair &pair : near.pairs()) {
    keep({false, all[pair.a].id, all[pair.b].id, false}, &pair.of_b);
    keep({false, all[pair.a].id, all[pair.b].id, true}, &pair.of_a);
  }
  for (const auto &[n, p] : near.planes()) keep({true, all[n].id, p, false}, nullptr);
  fields = std::move(kept);
}

void ContactWorld::forget()
{
  drop_lists();
  for (auto &[key, field] : fields) field->forget();
}

// Lists the points of all fields that may touch. Objects and fields do not depend on each other here.
void ContactWorld::find_points()
{
  std::vector<std::optional<PointFinder>> finder(all.size());
  threads.parts(objects(), NS_OF_OBJECT, [&](long first, long end) {
    for (long n = first; n < end; ++n)
      if (near.has_zones(static_cast<int>(n))) finder[n].emplace(all[n], arrays);
  });
  threads.parts(static_cast<long>(sums.all().size()), NS_OF_FIELD, [&](long first, long end) {
    for (long k = first; k < end; ++k) {
      const FieldSums::Active &one = sums.all()[k];
      one.field->list({all[one.a], all[one.b], *finder[one.a], *finder[one.b], one.host_zone, arrays, near.skin()});
    }
  });
  sums.weigh();
}

// --- particles ---

static Vec3 place(const Coordinates &places, std::size_t slot) { return {places[0][slot], places[1][slot], places[2][slot]}; }

namespace {

// Moves a rigid object: no point of the box around it goes farther, beside its middle, than a corner of the box.
void move_rigid(ContactObject &one, const Spot<double> &to)
{
  const std::array<Vec3, 8> before = one.corners();
  one.rigid = to;
  const std::array<Vec3, 8> now = one.corners();
  double square = 0.0;
  one.way = 0.5 * ((now[0] - before[0]) + (now[7] - before[7]));
  for (int c = 0; c < 8; ++c) {
    const Vec3 off = (now[c] - before[c]) - one.way;
    square = std::max(square, dot(off, off));
  }
  one.stir = std::sqrt(square);
}

// The place of a rigid object whose particles are here.
Spot<double> place_of(const ContactObject &one, const PaddedVec3 *place)
{
  Vec3 frame[RigidFrame::PARTICLES];
  for (int k = 0; k < RigidFrame::PARTICLES; ++k) frame[k] = place[one.slot[k]].value;
  Spot<double> spot;
  evaluate_frame(*one.body->frame(), frame, spot);
  return spot;
}

}    // namespace

void ContactWorld::place_rigid(const std::vector<Vec3> &frames, std::vector<Box> &boxes)
{
  std::size_t from = 0;
  for (int n = 0; n < objects(); ++n) {
    if (!all[n].is_rigid()) continue;
    Vec3 frame[RigidFrame::PARTICLES];
    for (Vec3 &one : frame) one = frames[from++];
    if (boxes[n].empty()) continue;    // an object without particles
    Spot<double> spot;
    evaluate_frame(*all[n].body->frame(), frame, spot);
    all[n].rigid_before = all[n].slot.empty() ? spot : all[n].rigid;    // without a place in the step before
    all[n].rigid.det > 0.0 ? move_rigid(all[n], spot) : void(all[n].rigid = spot);
    boxes[n] = Box();
    for (const Vec3 &corner : all[n].corners()) boxes[n].include(&corner.x);
  }
}

void ContactWorld::list(const std::vector<ContactParticle> &particles, const Coordinates &places)
{
  for (ContactObject &one : all) clear_forces(one, arrays), one.is_host = false;
  for (const NearObjects::NearPair &pair : near.pairs()) all[pair.a].is_host = all[pair.b].is_host = true;
  arrays.renew(particles.size());
  for (std::size_t slot = 0; slot < particles.size(); ++slot) arrays.place()[slot].value = place(places, slot);
  const PaddedVec3 *const last = has_before ? arrays.place_before_of_old_slots() : arrays.place_of_old_slots();
  for (int n = 0, to = 0; n < objects(); all[n++].last_slot = to)
    for (all[n].first_slot = to; to < static_cast<int>(particles.size()) && particles[to].object == n;) ++to;
  threads.parts(objects(), NS_OF_OBJECT, [&](long first, long end) {
    for (int n = static_cast<int>(first); n < end; ++n) {
      ContactObject &one = all[n];
      const std::vector<int> slot_before = std::move(one.slot);
      one.outer = std::make_shared<LateOuterCells>();
      one.slot.assign(near.has_zones(n) ? one.body->slots() : 0, -1);
      std::vector<Vec3> changes;    // since the last step, where the object already existed
      for (int slot = one.first_slot; slot < one.last_slot; ++slot) {
        const int at = one.body->slot_of(particles[slot].node);
        one.slot[at] = slot;
        const bool was_here = !slot_before.empty() && slot_before[at] >= 0;
        arrays.place_before()[slot] = was_here ? last[slot_before[at]] : arrays.place()[slot];
        if (was_here) changes.push_back(arrays.place()[slot].value - arrays.place_before()[slot].value);
      }
      one.find_outline(arrays.place());
      one.find_host_slots();
      one.is_calm = false, one.unchecked = -1.0;              // its cells that are here may be others
      if (!one.is_rigid()) tell_mean_motion(one, changes);    // else it has been placed
      one.find_crushed(arrays.place());
    }
  });
  list_fields();
  find_points();
  for (const int n : torn_now)    // points that are below a plane since another particle carries them
    for (const FieldSums::Active &one : sums.all())
      if (one.a == n && one.field->at_plane()) one.field->settle(arrays);
  torn_now.clear();
  listed = has_before = true;
}

void ContactWorld::tear(const TornEnds &ends, const Coordinates *places)
{
  if (places && !has_before) {
    move_to(*places);
    has_before = true;
  }
  for (const auto &[id, nodes] : ends) {
    const auto found = number_of.find(id);
    if (found == number_of.end() || all[found->second].is_rigid()) continue;
    ContactObject &one = all[found->second];
    if (one.body->is_line() && one.body->particles() == static_cast<int>(one.body->points().size())) continue;    // none between
    std::vector<int> slots;
    for (const int node : nodes) slots.push_back(one.body->slot_of(node));
    const std::shared_ptr<const TornBody> before = one.torn;
    one.torn = std::make_shared<const TornBody>(*one.body, slots);
    if (!places) continue;
    for (auto &[key, field] : fields) {
      const bool owns = owner_of(key) == found->second;
      if (owns) field->owner_tears(before.get(), arrays, account);
      if (owns || host_of(key) == found->second) field->forget();
    }
    torn_now.push_back(found->second);
  }
}

// --- steps ---

void ContactWorld::move_to(const Coordinates &places)
{
  if (!has_before) {
    arrays.keep_places();
    for (ContactObject &one : all) one.rigid_before = one.rigid;
  }
  const bool is_counted = has_before;    // the motion up to these places
  const PaddedVec3 *const last = is_counted ? arrays.place() : arrays.place_before();
  has_before = false;
  const ContactKernels &kernels = arrays.kernels ? *arrays.kernels : widest_kernels().contact;
  threads.parts(static_cast<long>(arrays.size()), NS_OF_PARTICLE, [&](long from, long to) {
    for (ContactObject &one : all) {
      if (one.first_slot == one.last_slot || one.first_slot < from || one.first_slot >= to) continue;
      PaddedVec3 *const now = arrays.place();
      if (one.is_rigid()) {
        for (int s = one.first_slot; s < one.last_slot; ++s) now[s].value = place(places, s);
        move_rigid(one, place_of(one, now));
        clear_forces(one, arrays);
        continue;
      }
      tell_motion(one, kernels, {places.data(), one.first_slot, one.last_slot, last, now, {}}, is_counted);
      one.find_crushed(now);
      clear_forces(one, arrays);
    }
  });
}

const ContactAccount &ContactWorld::booked()
{
  for (auto &[key, of_field] : losses) {
    for (const LossOfPoint &one : of_field) account.heat += one.heat, account.damped += one.damped;
    of_field.clear();
  }
  return account;
}

void ContactWorld::step(const Coordinates &places, double dt)
{
  account.begin_step();
  if (arrays.size() == 0) return;
  move_to(places);
  arrays.taken = false;
  sums.step(all, arrays, threads, dt, account);
}

// --- output ---

Vec3 ContactWorld::force_on_planes() const
{
  Vec3 sum;
  for (const auto &[key, field] : fields) sum += field->force_on_plane();
  return sum;
}

std::size_t ContactWorld::bytes_of_fields() const
{
  std::size_t sum = 0;
  for (const auto &[key, field] : fields) sum += sizeof key + field->bytes();
  return sum;
}

std::size_t ContactWorld::bytes_of_particles() const
{
  std::size_t sum = arrays.bytes();
  for (const ContactObject &one : all)
    sum += sizeof one + one.slot.capacity() * sizeof(int) + (one.outer ? one.outer->bytes() : 0) + one.outline.bytes();
  return sum;
}

}    // namespace mdanim
