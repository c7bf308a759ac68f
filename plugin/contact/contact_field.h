// SPDX-License-Identifier: GPL-2.0-only
// Points of one object's surface against a host: the undeformed depth of another object (lattice_field.h), or a plane
// (plane_field.h). A contact begins when a point is below every side of the host that faces it, and stays until the point has
// come out again. The beginning of a contact neither takes nor gives energy (docs/physics-contact.md).
//
// Another kind of host is a class derived from FieldOf, with its rows of contacts, and a line of ContactWorld::make().

#pragma once

#include "contact/contact_object.h"
#include "contact/contact_plane.h"
#include "contact/law.h"
#include "contact/points_at_plane.h"
#include "contact/wakes.h"
#include "records/byte_writer.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

namespace mdanim {

class LookBatches;

// Data for new lists of a field.
struct FieldLists {
  ContactObject &owner, &host;    // the present objects; the host of a plane is the owner
  const PointFinder &points, &of_host;
  const Zone *host_zone;    // of the host's particles near the owner; null for a plane
  const ContactArrays &arrays;
  double skin;    // how far objects may come nearer until lists are made again
};

class ContactField {
 public:
  ContactField(ContactObject &owner, ContactObject &host, const ContactLaw &law) : owner(&owner), host(&host), law(law) {}
  ContactField(const ContactField &) = delete;
  ContactField &operator=(const ContactField &) = delete;
  virtual ~ContactField() = default;

  void use(const ContactLaw &now) { law = now; }
  // Lists points that may touch until lists are made again; contacts and knowledge of points stay.
  virtual void list(const FieldLists &with) = 0;
  // Forgets all points except those in contact; must be followed by list().
  virtual void forget() = 0;
  // Looks at every point without a contact as it is now; no contact begins. For the setup of a run.
  void settle(const ContactArrays &arrays);
  // The part of a step that fields may do side by side, in three turns, so that waits for memory overlap and points of several
  // fields are looked at together: the points that are due, looks at them, and contacts that begin, once `batches` is finished.
  // dt = 0: nothing moves, as at the setup of a run. `now` is the budget: how much points and host have come nearer since it was
  // 0 [m].
  void find_due(double dt, double now);
  void look(const ContactArrays &arrays, LookBatches &batches);
  // Has what find_due() reads first brought into the cache, and what the contacts keep.
  void fetch_wakes() const { wake.fetch(); }
  virtual void fetch_contacts() const = 0;
  void end_looks(const ContactArrays &arrays);
  // The budget up to which a step has nothing to do with the field.
  double rests_until() const { return is_idle() ? wake.least_value() : AT_ONCE; }
  double budget_now() const { return budget; }
  void rest(double now) { budget = now; }
  // After end_looks(), computes contacts ahead for add_forces(), which otherwise computes them itself.
  virtual void work_ahead(const ContactArrays &arrays, double dt) = 0;
  // The part of a step that fields do one after the other.
  virtual void add_forces(ContactArrays &arrays, double dt, ContactAccount &account) = 0;

  // The owner is torn: contacts of points that are replaced end. `before` is null where it was whole. Places are those of this
  // step and the last one. Must be followed by forget() and list().
  virtual void owner_tears(const TornBody *before, const ContactArrays &arrays, ContactAccount &account) = 0;

  // Whether passes over blocks can compute its contacts: points are particles near a plane at rest. Then its points with their
  // contacts, by slots of particles; and these again with what has become of them.
  virtual bool fits_passes() const { return false; }
  virtual PointsAtPlane hand_over() const { return {}; }
  virtual void take_back(const PointsAtPlane & /*now*/, ContactAccount & /*account*/) {}

  virtual std::size_t touching() const = 0;    // number of contacts
  bool is_idle() const { return touching() == 0; }
  bool has_something() const { return !is_idle() || looks > 0; }      // whether there are forces to add, after end_looks()
  virtual int cost() const = 0;                                       // of a step, approximately, when lists were made [ns]
  virtual const ContactPlane *at_plane() const { return nullptr; }    // null for a field of two objects
  virtual Vec3 force_on_plane() const { return {}; }                  // in this step
  virtual void put_rows(ByteWriter &writer) const = 0;                // of contacts, without their number
  virtual std::size_t bytes() const = 0;

 protected:
  static constexpr double NEVER = Wakes::NEVER;
  static constexpr double AT_ONCE = -NEVER;    // budgets at planes fall below 0
  static constexpr double ROUNDING = 1e-9;     // cells that a budget may be wrong by, and more

  // Upper bound of how much points and host have come nearer since the last step [m].
  virtual double approach() const = 0;
  // Looks at a point without a contact: whether a contact begins; otherwise sets when to look again.
  virtual bool look_at(std::size_t q, const ContactArrays &arrays, bool may_begin) = 0;
  // The same for several points; contacts may begin.
  virtual void look_at_all(const std::vector<std::size_t> &points, const ContactArrays &arrays, LookBatches &)
  {
    for (const std::size_t q : points) look_at(q, arrays, true);
  }
  // Has what is known of points brought into the cache.
  virtual void fetch(const std::vector<std::size_t> &points) const = 0;
  // Whether a point is due in each step while its host is crushed, because looks do not tell when to look again.
  virtual bool distrusts(std::size_t q) const = 0;
  // For the forces of a step, once contacts have begun.
  virtual void begin_step(const ContactArrays &arrays) = 0;

  ContactObject *owner, *host;
  ContactLaw law;
  std::vector<int> near;                  // points
  Wakes wake;                             // of these, against `budget`
  std::vector<std::size_t> of_contact;    // near points of contacts
  int looks = 0;                          // at points of objects, in this step
  double budget = 0.0;
};

// A field whose contacts are rows of a kind, by ascending points, and which keeps a Known of each near point.
template <class Contact, class Known> class FieldOf : public ContactField {
 public:
  using ContactField::ContactField;

  void restore(std::vector<Contact> rows) { contacts = std::move(rows); }
  std::size_t touching() const final { return contacts.size(); }
  void put_rows(ByteWriter &writer) const final { writer.put_all(contacts); }
  void fetch_contacts() const final
  {
    constexpr std::size_t LINE = 64, MOST = 4096;    // more is read ahead by the processor
    const char *const first = reinterpret_cast<const char *>(contacts.data());
    for (std::size_t n = 0; n < std::min(MOST, contacts.size() * sizeof(Contact)); n += LINE) __builtin_prefetch(first + n);
  }
  void forget() final
  {
    near.clear(), wake.clear(), known.clear(), of_contact.clear();
    budget = 0.0;
  }

 protected:
  // Lists points in a zone that are not farther than `reach` from the host. `trusted`: the longest way to go with which the last
  // look at a point is still trusted. distance(x): lower bound of the distance from the host.
  template <class Distance>
  void list_points(const FieldLists &with, const Zone &zone, bool on_flat, double reach, double trusted, const Distance &distance)
  {
    const std::vector<int> points_before = std::move(near);
    const std::vector<Known> known_before = std::move(known);
    const Wakes wake_before = std::move(wake);
    const double now = budget + approach();
    forget();
    wake.set_early(ROUNDING * owner->body->spacing());
    budget = now;
    std::size_t before = 0, contact = 0;
    for (const int p : with.points.inside(zone, on_flat, contacts)) {
      while (contact < contacts.size() && contacts[contact].point < p) ++contact;
      const bool touches = contact < contacts.size() && contacts[contact].point == p;
      while (before < points_before.size() && points_before[before] < p) ++before;
      if (!(at_plane() ? owner->has_place_of(p) : owner->has_point(p))) continue;
      const double out = distance(owner->place_of(p, with.arrays.place()));
      const bool is_known = before < points_before.size() && points_before[before] == p;
      if (!touches && out > reach) continue;
      near.push_back(p);
      if (touches) of_contact.push_back(near.size() - 1);
      known.push_back(is_known ? known_before[before] : Known{});
      const double seen = is_known && wake_before[before] < NEVER ? std::min(wake_before[before], budget + trusted) : AT_ONCE;
      wake.push_back(touches ? NEVER : std::max(budget + out, seen));
    }
    drop_lost_contacts();
  }

  void fetch(const std::vector<std::size_t> &points) const final
  {
    const ContactBody &body = *owner->body;
    for (const std::size_t q : points) {
      __builtin_prefetch(&known[q]);
      __builtin_prefetch(&body.facings()[near[q]]);
      __builtin_prefetch(&body.points()[near[q]].kind);
      __builtin_prefetch(body.carriers_of(near[q]).first);
    }
  }
  void begin(std::size_t q, const Contact &contact)
  {
    const auto where = std::lower_bound(of_contact.begin(), of_contact.end(), q);
    contacts.insert(contacts.begin() + (where - of_contact.begin()), contact);
    of_contact.insert(where, q);
    wake.set(q, NEVER);
  }
  // Moves contact `c` to place `left`, the number of those before it that continue.
  void keep(std::size_t c, std::size_t &left)
  {
    if (left < c) contacts[left] = contacts[c], of_contact[left] = of_contact[c];
    ++left;
  }
  void keep_first(std::size_t left) { contacts.resize(left), of_contact.resize(left); }
  std::size_t bytes_of_rows() const
  {
    return near.capacity() * sizeof(int) + wake.bytes() + known.capacity() * sizeof(Known) +
           contacts.capacity() * sizeof(Contact) + of_contact.capacity() * sizeof(std::size_t);
  }

  std::vector<Known> known;
  std::vector<Contact> contacts;

 private:
  // Ends contacts of points whose particles are not here.
  void drop_lost_contacts()
  {
    if (of_contact.size() == contacts.size()) return;
    std::size_t left = 0, n = 0;
    for (const std::size_t q : of_contact) {
      while (contacts[n].point != near[q]) ++n;
      contacts[left++] = contacts[n];
    }
    contacts.resize(left);
  }
};

}    // namespace mdanim
