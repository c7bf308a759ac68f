// SPDX-License-Identifier: GPL-2.0-only
// Points of one object's surface against the undeformed depth of another. Derived classes know how places in space are found in
// it: lattice_field.h by the cells of an object that deforms, rigid_field.h by the frame of one that does not.

#pragma once

#include "contact/contact_birth.h"
#include "contact/contact_field.h"
#include "contact/contact_kernel.h"
#include "contact/point_search.h"

#include <vector>

namespace mdanim {

class ObjectField : public FieldOf<FieldContact, PointTrack> {
 public:
  using FieldOf::FieldOf;

  void work_ahead(const ContactArrays &arrays, double dt) override;
  void add_forces(ContactArrays &arrays, double dt, ContactAccount &account) override;
  int cost() const override;
  void owner_tears(const TornBody *before, const ContactArrays &arrays, ContactAccount &account) override;
  std::size_t bytes() const override
  { return bytes_of_rows() + now.capacity() * sizeof(PointNow) + ahead.capacity() * sizeof(PushedBlock); }

 protected:
  enum class Fate { STAYS, OUT, LOST, CRUSHED };

  // The work of a contact in a step, one at a time.
  virtual Fate push(FieldContact &contact, std::size_t q, const PushTask &task, const PointNow &now, ContactArrays &arrays,
                    ContactAccount &account) const = 0;

  double approach() const override { return nearer(*owner, *host); }
  bool distrusts(std::size_t q) const override { return known[q].cell[0] != -1; }    // what is near to the host
  void begin_step(const ContactArrays &arrays) override;
  const SurfacePoint &surface_point(std::size_t q) const { return owner->body->points()[near[q]]; }
  // False where not all of its particles are here.
  bool find_facing(std::size_t q, const Moment &at, Facing &facing) const;
  // Begins a contact at X as a look found it; `was_open` are the sides that were open in the step before.
  void begin_contact(std::size_t q, const Verdict &verdict, const Vec3 &X, const std::array<int, 3> &cell, std::uint8_t was_open);
  // Adds forces to the point.
  void push_point(const FieldContact &contact, std::size_t q, const PushedContact<double> &found, bool on_ramp,
                  ContactArrays &arrays) const;
  static void count(const FieldContact &contact, const PushedContact<double> &found, ContactAccount &account);

 private:
  PushTask task(PointKind kind, const ContactArrays &arrays, double dt) const;
  PointNow point_now(std::size_t q, const ContactArrays &arrays) const;
  void push_run(std::size_t first, std::size_t end, std::size_t &left, std::size_t &block, const PushTask &task,
                ContactArrays &arrays, ContactAccount &account);
  template <class Do> void each_run(double dt, const ContactArrays &arrays, const Do &run) const;
  void end(const FieldContact &contact, std::size_t q, Fate fate, const ContactArrays &arrays, ContactAccount &account);

  std::vector<PointNow> now;         // the points of contacts in this step
  std::vector<PushedBlock> ahead;    // their results, four at a time, kind by kind,
  std::size_t known_ahead = 0;       // number of these in this step
};

}    // namespace mdanim
