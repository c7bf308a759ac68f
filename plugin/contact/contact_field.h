// SPDX-License-Identifier: GPL-2.0-only
// Points of one object's surface against the undeformed depth of another, its host (docs/physics-contact.md). A contact begins
// when a point is below every side of the host that faces it, and stays with the nearest of those sides until the point has come
// out again. The beginning of a contact neither takes nor gives energy.

#pragma once

#include "contact/contact_kernel.h"
#include "contact/contact_object.h"
#include "contact/wakes.h"

#include <array>
#include <cstdint>
#include <vector>

namespace mdanim {

class ContactField {
 public:
  ContactField(ContactObject &owner, ContactObject &host, const ContactLaw &law) : owner(&owner), host(&host), law(law) {}

  void use(const ContactLaw &now) { law = now; }

  static constexpr double STRETCHED = 2.0;    // the largest stretch that is assumed of cells
  // How far a point may be outside of its host's particles in contact.
  static double stands_out(const ContactBody &owner, const ContactBody &host);
  // Lists points that may touch until lists are made again; contacts and knowledge of points stay. `reach`: how far objects may
  // come nearer; `nearer`: upper bound of how much they have come nearer since the last step. Objects and slots are the present
  // ones; the finder is that of the first object; outside of the zone points cannot touch.
  void list(ContactObject &points_of, ContactObject &host_now, const PointFinder &finder, const Zone &zone,
            const ContactArrays &arrays, double reach, double nearer);
  // Forgets all points except those in contact; must be followed by list().
  void forget();
  // Looks at every point without a contact as it is now; no contact begins. For the setup of a run.
  void settle(const ContactArrays &arrays);
  // The part of a step that fields may do side by side: contacts begin. `nearer`: upper bound of how much the objects have come
  // nearer in this step [m]. dt = 0: nothing moves, as at the setup of a run.
  void look(const ContactArrays &arrays, double nearer, double dt);
  // After look(), computes contacts ahead for add_forces(), which otherwise computes them itself.
  void work_ahead(const ContactArrays &arrays, double dt);
  // The part of a step that fields do one after the other.
  void add_forces(ContactArrays &arrays, double dt, ContactAccount &account);

  bool has_something() const { return !contacts.empty() || looks > 0; }    // whether there are forces to add, after look()
  int cost() const;                                                        // of a step, approximately, when lists were made [ns]
  bool is_idle() const { return contacts.empty(); }
  const std::vector<FieldContact> &touching() const { return contacts; }
  void restore(std::vector<FieldContact> those) { contacts = std::move(those); }
  std::size_t bytes() const;

 private:
  static constexpr double NEVER = Wakes::NEVER;
  static constexpr std::uint8_t EVERY_SIDE = 63;

  struct Watch {
    std::array<int, 3> cell = {-1, -1, -1};    // where it was found last, -1 for nowhere
    Vec3 X;
    double room = 0.0;        // a motion that leaves it in this cell [m]
    std::uint8_t open = 0;    // sides in which the point would have had a potential when it was looked at last
  };

  // The result of a look at a point.
  struct Verdict {
    int side = -1;    // of the contact that begins; -1 for none
    double depth = 0.0;
    std::uint8_t open = 0;    // as that of Watch
    double slack = 0.0;       // a motion that cannot yet begin a contact [m]
    bool is_crushed = false;
    bool is_sure = true;    // no contact, and open is right, although the place of the point is guessed
  };

  Placed placed(const ContactArrays &arrays) const { return {*host->body, host->slot.data(), arrays.place()}; }
  const SurfacePoint &surface_point(std::size_t q) const { return owner->body->points()[near.point(q)]; }
  bool is_smooth(PointKind kind) const { return kind != PointKind::FLAT && host->body->is_cuboid(); }
  bool look(std::size_t q, const ContactArrays &arrays, bool may_begin);
  bool find(std::size_t q, const Vec3 &x, const Placed &at, Spot<double> &spot, Vec3 &X);
  void guess(std::size_t q, const Vec3 &x, const Placed &at, Spot<double> &spot, Vec3 &X, double &off);
  std::array<int, 3> cell_of(const Vec3 &X) const;
  std::array<int, 3> cell_nearest(const Vec3 &x, std::array<int, 3> cell, const Placed &at, double &room) const;
  double slack_of_far(const SurfacePoint &point, const Vec3 &X, const Vec3 &X_centre, double off) const;
  Verdict judge(const SurfacePoint &point, const Vec3 &X, const Vec3 &X_centre, const Spot<double> &spot, const Vec3 &normal,
                double off) const;
  bool world_normal(const SurfacePoint &point, const ContactArrays &arrays, Vec3 &normal) const;
  Ramps ramps(PointKind kind) const;

  enum class Fate { STAYS, OUT, LOST, CRUSHED };
  // A contact that continues in another cell in a step: how far the point has moved against the host in the cell that it leaves
  // [m], and the difference between X and its place there.
  struct Hop {
    bool happened = false;
    Vec3 moved, jump;
  };
  PushTask task(PointKind kind, const ContactArrays &arrays, double dt) const;
  PointNow point_now(std::size_t q, const ContactArrays &arrays) const;
  bool follow(FieldContact &contact, const PushTask &task, const Vec3 &x, MapWeights &weights, Spot<double> &spot, Vec3 &off,
              Hop &hop) const;
  void go_on(FieldContact &contact, const Hop &hop, const Spot<double> &spot) const;
  Fate push(FieldContact &contact, std::size_t q, const PushTask &task, const PointNow &now, ContactArrays &arrays,
            ContactAccount &account) const;
  void take(const FieldContact &contact, std::size_t q, const PushedBlock &pushed, int lane, ContactArrays &arrays,
            ContactAccount &account) const;
  void count(const FieldContact &contact, double heat, double damped, ContactAccount &account) const;
  void push_run(std::size_t first, std::size_t end, std::size_t &left, std::size_t &block, const PushTask &task,
                ContactArrays &arrays, ContactAccount &account);
  template <class Do> void each_run(double dt, const ContactArrays &arrays, const Do &run) const;
  void end(const FieldContact &contact, std::size_t q, Fate fate, const ContactArrays &arrays, ContactAccount &account);

  ContactObject *owner, *host;
  ContactLaw law;
  NearPoints near;
  Wakes wake;    // of near points, against `budget`
  std::vector<Watch> watch;
  std::vector<FieldContact> contacts;     // by ascending points
  std::vector<std::size_t> of_contact;    // their near points
  std::vector<PointNow> now;              // and their points in this step
  std::vector<PushedBlock> ahead;         // their results, four at a time, kind by kind,
  std::size_t known_ahead = 0;            // number of these in this step
  int looks = 0;                          // in this step
  double budget = 0.0;
};

}    // namespace mdanim
