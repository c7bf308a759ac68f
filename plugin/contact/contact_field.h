// SPDX-License-Identifier: GPL-2.0-only
// Points of one object's surface against the undeformed depth of another, its host (docs/physics-contact.md).
// A contact is born when a point is below every side of the host that faces it, and stays with the nearest of those sides until
// the point has come out again. A birth is free of energy.

#ifndef MDANIM_CONTACT_FIELD_H
#define MDANIM_CONTACT_FIELD_H

#include "contact/contact_object.h"
#include "laws/contact.h"

#include <array>
#include <cstdint>
#include <vector>

namespace mdanim {

// A point in contact. All but forces are in the host's lattice coordinates.
struct FieldContact {
  std::int32_t point, side;
  std::int32_t cell[3], spare;
  Vec3 X, change;    // in the last step, and from the one before
  Vec3 anchor;
  ContactMemory memory;
  Vec3 force;       // on the point in the last step [N]
  Vec3 moved;       // against the host in the last step [m]
  double energy;    // of the pressure, in the last step [J]
};

class ContactField {
 public:
  ContactField(ContactObject &owner, ContactObject &host, const ContactLaw &law) : owner(&owner), host(&host), law(law) {}

  // Points that may come in until lists are made again; contacts and what is known of points stay. `reach`: how far objects may
  // come nearer. Objects and slots are as they are now.
  void list(ContactObject &points_of, ContactObject &host_now, const ContactArrays &arrays, double reach);
  // Nothing is known of points but of those in contact; to be followed by list().
  void forget();
  // Looks at every point without a contact as it is now; nothing is born. For the setup of a run.
  void settle(const ContactArrays &arrays);
  // `nearer`: how much the objects have come nearer at most in this step [m]. dt = 0: nothing moves, as at the setup of a run.
  void add_forces(ContactArrays &arrays, double nearer, double dt, ContactAccount &account);

  bool is_idle() const { return contacts.empty(); }
  const std::vector<FieldContact> &touching() const { return contacts; }
  void restore(std::vector<FieldContact> those) { contacts = std::move(those); }
  std::size_t bytes() const;

 private:
  struct Watch {
    std::array<int, 3> cell = {-1, -1, -1};    // where it was found last, -1 for nowhere
    Vec3 X;
    std::uint8_t open = 0;    // sides in which the point would have had a potential when it was looked at last
  };

  Placed placed(const ContactArrays &arrays) const { return {*host->body, host->slot.data(), arrays.place.data()}; }
  const SurfacePoint &surface_point(std::size_t q) const { return owner->body->points()[near.point(q)]; }
  bool is_smooth(const SurfacePoint &point) const { return point.kind != PointKind::FLAT && host->body->is_cuboid(); }
  bool look(std::size_t q, const ContactArrays &arrays, bool may_begin);
  bool find(std::size_t q, const Vec3 &x, const Placed &at, Spot &spot, Vec3 &X);
  std::array<int, 3> nearest_cell(const Vec3 &x, const ContactArrays &arrays);
  bool world_normal(const SurfacePoint &point, const ContactArrays &arrays, Vec3 &normal) const;
  bool follow(FieldContact &contact, const SurfacePoint &point, const Vec3 &x, const Placed &at, Weights &weights, Spot &spot,
              Vec3 &off) const;
  enum class Fate { STAYS, OUT, LOST };
  Fate push(FieldContact &contact, std::size_t q, ContactArrays &arrays, double dt, ContactAccount &account);
  void end(const FieldContact &contact, std::size_t q, Fate fate, const ContactArrays &arrays, ContactAccount &account);
  double part(const SurfacePoint &point, const Vec3 &X, int side, Vec3 &slope) const;
  double ramp_width(const SurfacePoint &point, int axis, double &from) const;

  ContactObject *owner, *host;
  ContactLaw law;
  NearPoints near;
  std::vector<double> wake;    // of near points: what `budget` must come to before one is looked at
  std::vector<Watch> watch;
  std::vector<FieldContact> contacts;     // by ascending points
  std::vector<std::size_t> of_contact;    // their near points
  double budget = 0.0;
  Box host_box;
  // Cells of the host on its surface, for points that have not been found yet: made when the first is asked for.
  std::vector<std::array<int, 3>> outer;
  std::vector<Vec3> outer_middle;
  std::vector<Grid> outer_grid;    // one or none
};

}    // namespace mdanim

#endif
