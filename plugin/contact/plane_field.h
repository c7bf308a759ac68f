// SPDX-License-Identifier: GPL-2.0-only
// Points of one object's surface against a plane across an axis, below which the depth is known exactly. The plane is rigid and
// does not move.

#pragma once

#include "contact/contact_field.h"

#include <cstdint>
#include <optional>
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

// Known of a point: whether it was below when it was looked at last.
class PlaneField : public FieldOf<PlaneContact, std::uint8_t> {
 public:
  // Reach of lists over the skin: 1/2 for particles, and half of that for points outside of cells.
  static constexpr double REACH = 0.75;

  PlaneField(ContactObject &owner, int number, const ContactPlane &plane, const ContactLaw &law)
      : FieldOf(owner, owner, law), number(number), plane(plane)
  {
  }

  void list(const FieldLists &with) override;
  void work_ahead(const ContactArrays &arrays, double dt) override;
  void add_forces(ContactArrays &arrays, double dt, ContactAccount &account) override;
  int cost() const override;
  std::optional<Vec3> normal() const override { return plane.normal(); }
  Vec3 force_on_plane() const override { return on_plane; }
  std::size_t bytes() const override { return bytes_of_rows() + ahead.capacity() * sizeof(OnPoint); }

 private:
  struct OnPoint {
    Vec3 force;
    double depth, energy, heat, damped;
  };
  double depth_at(const Vec3 &x) const { return plane.depth(x) + owner->body->radius(); }
  double approach() const override { return nearer(*owner, plane.normal()); }
  bool look_at(std::size_t q, const ContactArrays &arrays, bool may_begin) override;
  bool distrusts(std::size_t) const override { return false; }
  void begin_step(const ContactArrays &arrays) override;
  OnPoint push(PlaneContact &contact, std::size_t q, const ContactArrays &arrays, double dt) const;

  int number;
  ContactPlane plane;
  std::vector<OnPoint> ahead;
  Vec3 on_plane;
};

}    // namespace mdanim
