// SPDX-License-Identifier: GPL-2.0-only
// Points of one object's surface against a plane across an axis, below which the depth is known exactly. The plane is rigid; it
// may be moved without being turned.

#pragma once

#include "contact/contact_field.h"
#include "contact/contact_plane.h"
#include "contact/points_at_plane.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace mdanim {

// Known of a point: whether it was below when it was looked at last.
class PlaneField : public FieldOf<PlaneContact, std::uint8_t> {
 public:
  // Reach of lists over the skin: 1/2 for particles, and half of that for points outside of cells.
  static constexpr double REACH = 0.75;

  // The plane, and losses by ascending points, must outlive the field.
  PlaneField(ContactObject &owner, int number, const ContactPlane &plane, const ContactLaw &law, std::vector<LossOfPoint> &losses)
      : FieldOf(owner, owner, law), number(number), plane(plane), losses(losses)
  {
  }

  void list(const FieldLists &with) override;
  void work_ahead(const ContactArrays &arrays, double dt) override;
  void add_forces(ContactArrays &arrays, double dt, ContactAccount &account) override;
  int cost() const override;
  const ContactPlane *at_plane() const override { return &plane; }
  void owner_tears(const TornBody *before, const ContactArrays &arrays, ContactAccount &account) override;
  Vec3 force_on_plane() const override { return on_plane; }
  // The force on a plane that moves, for the work of the next step.
  Vec3 kept_force() const { return before.value_or(Vec3{}); }
  void restore_force(const Vec3 &force) { before = force; }
  bool fits_passes() const override;
  PointsAtPlane hand_over() const override;
  void take_back(const PointsAtPlane &now, ContactAccount &account) override;
  std::size_t bytes() const override { return bytes_of_rows() + ahead.capacity() * sizeof(PlanePush<double>); }

 private:
  // Losses are then summed point by point, as in passes.
  bool may_be_in_passes() const { return are_particles && !plane.moves && !owner->is_rigid(); }
  double depth_at(const Vec3 &x) const { return plane.depth(x) + owner->body->radius(); }
  double approach() const override { return nearer(*owner, plane.normal(), plane.way); }
  bool look_at(std::size_t q, const ContactArrays &arrays, bool may_begin) override;
  bool distrusts(std::size_t) const override { return false; }
  void begin_step(const ContactArrays &arrays) override;
  PlanePush<double> push(PlaneContact &contact, std::size_t q, const ContactArrays &arrays, double dt) const;
  void push_all(const ContactArrays &arrays, double dt);
  void end(const PlaneContact &contact, std::size_t q, double depth, LossOfPoint &loss);
  void add_losses(const std::vector<LossOfPoint> &more);

  int number;
  const ContactPlane &plane;
  std::vector<LossOfPoint> &losses;
  bool are_particles = false;              // points that are near
  std::vector<PlanePush<double>> ahead;    // of contacts in this step
  Vec3 on_plane;
  std::optional<Vec3> before;    // force on a plane that moves in the step before; none at the start
};

}    // namespace mdanim
