// SPDX-License-Identifier: GPL-2.0-only
// Points of one object's surface against a plane across an axis, below which the depth is known exactly. The law is that of
// contact_field.h; the plane is rigid and does not move.

#pragma once

#include "contact/contact_object.h"
#include "contact/law.h"
#include "contact/wakes.h"

#include <cstdint>
#include <vector>

namespace mdanim {

struct ContactPlane {
  int axis;
  double sign;    // 1: objects belong above, -1: below
  double at;      // [m]
  double depth(const Vec3 &x) const { return sign * (at - (axis == 0 ? x.x : axis == 1 ? x.y : x.z)); }
  // The zone up to `gap` above the plane.
  Zone within(double gap) const
  {
    Zone zone;
    for (double &side : zone.box.bound) side = -Box::FAR;
    zone.across = -1.0 * normal();
    zone.from = -sign * at - gap;
    return zone;
  }
  Vec3 normal() const { return {axis == 0 ? sign : 0.0, axis == 1 ? sign : 0.0, axis == 2 ? sign : 0.0}; }
};

struct PlaneContact {
  std::int32_t point, plane;
  Vec3 anchor;    // [m]
  ContactMemory<double> memory;
};

class PlaneField {
 public:
  PlaneField(ContactObject &owner, int number, const ContactPlane &plane, const ContactLaw &law)
      : owner(&owner), number(number), plane(plane), law(law)
  {
  }

  // As those of ContactField.
  void use(const ContactLaw &now) { law = now; }
  void list(ContactObject &points_of, const PointFinder &finder, const ContactArrays &arrays, double reach);
  void forget();
  void settle(const ContactArrays &arrays);
  void look(const ContactArrays &arrays, double dt);
  void work_ahead(const ContactArrays &arrays, double dt);
  void add_forces(ContactArrays &arrays, double dt, ContactAccount &account);
  int cost() const;

  const std::vector<PlaneContact> &touching() const { return contacts; }
  void restore(std::vector<PlaneContact> those) { contacts = std::move(those); }
  const Vec3 &force_on_plane() const { return on_plane; }
  std::size_t bytes() const;

 private:
  struct Pushed {
    Vec3 on_point;
    double depth, energy, heat, damped;
  };
  Pushed push(PlaneContact &contact, std::size_t q, const ContactArrays &arrays, double dt) const;
  bool look(std::size_t q, const ContactArrays &arrays, bool may_begin);

  ContactObject *owner;
  int number;
  ContactPlane plane;
  ContactLaw law;
  NearPoints near;
  Wakes wake;                             // as that of ContactField
  std::vector<std::uint8_t> was_below;    // whether a near point was below when it was looked at last
  std::vector<PlaneContact> contacts;     // by ascending points
  std::vector<std::size_t> of_contact;
  std::vector<Pushed> ahead;
  double budget = 0.0;
  Vec3 on_plane;
};

}    // namespace mdanim
