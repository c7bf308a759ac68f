// SPDX-License-Identifier: GPL-2.0-only
// Points of one object's surface against the undeformed depth of another, whose lattice maps places in space into it.

#pragma once

#include "contact/object_field.h"

namespace mdanim {

class LatticeField : public ObjectField {
 public:
  using ObjectField::ObjectField;

  static constexpr double STRETCHED = 2.0;    // the largest stretch that is assumed of cells
  static constexpr double NEAREST = 2.2;      // in cells, from the middle of a cell on the surface; no contact beyond
  // How far a point may be outside of its host's particles in contact.
  static double stands_out(const ContactBody &owner, const ContactBody &host);

  void list(const FieldLists &with) override;

  // For looks at points of several fields.
  LookTask look_task(bool is_smooth, const ContactArrays &arrays) const;
  bool looks_like(const LatticeField &other) const { return host->body == other.host->body && owner->body == other.owner->body; }
  void take_look(std::size_t q, const LookedBlock &looked, int lane, const ContactArrays &arrays);

 private:
  static Verdict lost();
  bool start(const Vec3 &x, const Moment &at, const ContactArrays &arrays, PointTrack &track, std::array<int, 3> &cell,
             Verdict &verdict) const;
  bool is_surely_apart(std::size_t q, const Vec3 &x, const Moment &at, PointTrack &track, Verdict &verdict) const;
  Verdict sight(std::size_t q, const Moment &at, const ContactArrays &arrays, PointTrack &track, Vec3 &X) const;
  bool is_near(std::size_t q, const Moment &at, const ContactArrays &arrays, Verdict &verdict);
  bool is_beside_outline(std::size_t q, const ContactArrays &arrays);
  bool look_closely(std::size_t q, const ContactArrays &arrays, bool may_begin);
  void put_off(std::size_t q, double slack);
  bool look_at(std::size_t q, const ContactArrays &arrays, bool may_begin) override;
  void look_at_all(const std::vector<std::size_t> &points, const ContactArrays &arrays, LookBatches &batches) override;
  Fate push(FieldContact &contact, std::size_t q, const PushTask &task, const PointNow &now, ContactArrays &arrays,
            ContactAccount &account) const override;
};

}    // namespace mdanim
