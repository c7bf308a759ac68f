// SPDX-License-Identifier: GPL-2.0-only
// Points of one object's surface against the undeformed depth of another, whose lattice maps places in space into it.

#pragma once

#include "contact/contact_field.h"
#include "contact/contact_kernel.h"
#include "contact/point_search.h"

#include <vector>

namespace mdanim {

class LatticeField : public FieldOf<FieldContact, PointTrack> {
 public:
  using FieldOf::FieldOf;

  static constexpr double STRETCHED = 2.0;    // the largest stretch that is assumed of cells
  // How far a point may be outside of its host's particles in contact.
  static double stands_out(const ContactBody &owner, const ContactBody &host);

  void list(const FieldLists &with) override;
  void work_ahead(const ContactArrays &arrays, double dt) override;
  void add_forces(ContactArrays &arrays, double dt, ContactAccount &account) override;
  int cost() const override;
  std::size_t bytes() const override
  { return bytes_of_rows() + now.capacity() * sizeof(PointNow) + ahead.capacity() * sizeof(PushedBlock); }

 private:
  enum class Fate { STAYS, OUT, LOST, CRUSHED };

  double approach() const override { return nearer(*owner, *host); }
  bool look_at(std::size_t q, const ContactArrays &arrays, bool may_begin) override;
  void begin_step(const ContactArrays &arrays) override;
  const SurfacePoint &surface_point(std::size_t q) const { return owner->body->points()[near.point(q)]; }
  bool world_normal(const SurfacePoint &point, const ContactArrays &arrays, Vec3 &normal) const;
  PushTask task(PointKind kind, const ContactArrays &arrays, double dt) const;
  PointNow point_now(std::size_t q, const ContactArrays &arrays) const;
  Fate push(FieldContact &contact, std::size_t q, const PushTask &task, const PointNow &now, ContactArrays &arrays,
            ContactAccount &account) const;
  void take(const FieldContact &contact, std::size_t q, const PushedBlock &pushed, int lane, ContactArrays &arrays,
            ContactAccount &account) const;
  void count(const FieldContact &contact, double heat, double damped, ContactAccount &account) const;
  void push_run(std::size_t first, std::size_t end, std::size_t &left, std::size_t &block, const PushTask &task,
                ContactArrays &arrays, ContactAccount &account);
  template <class Do> void each_run(double dt, const ContactArrays &arrays, const Do &run) const;
  void end(const FieldContact &contact, std::size_t q, Fate fate, const ContactArrays &arrays, ContactAccount &account);

  std::vector<PointNow> now;         // the points of contacts in this step
  std::vector<PushedBlock> ahead;    // their results, four at a time, kind by kind,
  std::size_t known_ahead = 0;       // number of these in this step
};

}    // namespace mdanim
