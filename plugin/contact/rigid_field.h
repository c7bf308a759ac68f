// SPDX-License-Identifier: GPL-2.0-only
// Points of one object's surface against the depth of another that does not deform: its frame (rigid_map.h) maps any place into
// it at once. No search, no cells, and no contact is let go.

#pragma once

#include "contact/object_field.h"

namespace mdanim {

class RigidField : public ObjectField {
 public:
  using ObjectField::ObjectField;

  void list(const FieldLists &with) override;

 private:
  Vec3 to_material(const Vec3 &x) const { return host->rigid.to_material(x - host->rigid.x); }
  double outside(const Vec3 &X) const;
  Verdict sight(std::size_t q, const Moment &at, Vec3 &X) const;
  bool look_at(std::size_t q, const ContactArrays &arrays, bool may_begin) override;
  Fate push(FieldContact &contact, std::size_t q, const PushTask &task, const PointNow &now, ContactArrays &arrays,
            ContactAccount &account) const override;
};

}    // namespace mdanim
