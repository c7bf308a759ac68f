// SPDX-License-Identifier: GPL-2.0-only
// An object in contact: its body and material, and the places of its particles.

#pragma once

#include "contact/contact_body.h"
#include "contact/material_map.h"
#include "contact/outline.h"
#include "contact/padded_vec3.h"
#include "geometry/zone.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace mdanim {

struct ContactKernels;
class LateOuterCells;

// An object of which links are gone. A cell with a particle of such a link pushes at no point of others: what is left of the body
// around it is not known. Points that such a particle carries, with others or alone, are replaced: each of their particles gets
// one of them for its own, with the area that it carried, so that contact is as stiff as before for each particle at most; points
// that are left over are none. A particle inside of the body is a point from when on a cell around it is torn: one that has both
// ends of a link that is gone. Of a line, points between particles are none any more, once a link between these is gone.
class TornBody {
 public:
  // Both ends of each link that is gone, one behind the other, by places of particles (ContactBody::slot_of()).
  TornBody(const ContactBody &body, const std::vector<int> &ends);

  bool is_at_tear(int slot) const { return at_tear[slot] != 0; }
  bool is_replaced(int point) const { return replaced[point] != 0; }
  PointCarriers carriers_of(int point) const
  {
    const int *const at = &first[2 * point];
    return {&carriers[at[0]], &carriers[at[1]], &carriers[at[2]]};
  }
  BodyCarriers all_carriers() const { return {carriers.data(), first.data()}; }
  const double *areas() const { return area.data(); }
  std::size_t bytes() const
  {
    return at_tear.capacity() + replaced.capacity() + carriers.capacity() * sizeof(PointCarrier) +
           first.capacity() * sizeof(int) + area.capacity() * sizeof(double);
  }

 private:
  std::vector<char> laid_bare(const ContactBody &body, const std::vector<int> &ends) const;
  void find_replaced(const ContactBody &body, const std::vector<char> &bare);
  void find_torn_between(const ContactBody &body, const std::vector<int> &ends);
  std::vector<int> own_particles(const ContactBody &body);

  std::vector<char> at_tear, replaced;    // by places of particles, and by points
  std::vector<PointCarrier> carriers;
  std::vector<int> first;
  std::vector<double> area;
};

// All particles where they are now, or where they were in the step before.
struct Moment {
  const PaddedVec3 *place;    // by slots
  bool is_before;
};

struct ContactObject {
  int id;    // ascending in the order of the scene
  std::shared_ptr<const ContactBody> body;
  double young;                // [force/distance^2]
  double friction;             // mu
  double density;              // of the lattice [force time^2/distance^4]: the ratio of force to acceleration, per volume
  std::int64_t first_tag;      // tag of the first of its particles
  bool is_excepted = false;    // contacts with others of this kind, and with planes, are left to another fix

  std::vector<int>
      slot{};    // numbers of its particles by ContactBody::slot_of(), in the arrays of ContactWorld; -1 for one that is not here
  int first_slot = 0, last_slot = 0;
  std::shared_ptr<LateOuterCells> outer{};    // empty until first asked for after lists were made
  Spot<double> rigid{}, rigid_before{};       // of a rigid body: x(X) at X = 0, and its gradient; those of the step before
  bool takes_force = true;                    // whether forces on its particles matter
  Vec3 way{};                 // mean displacement of its particles, or that of the middle of a rigid body, in this step
  double stir = 0.0;          // the largest displacement of a point relative to that in this step, or more
  Vec3 usual{};               // that mean in the last step in which it could move
  bool is_host = false;       // another object may touch it until lists are made again
  bool is_pushed = false;     // by contacts, in the last step
  bool is_crushed = false;    // some cell is: a place in space may then be in several cells
  bool is_calm = false;       // no cell is soon, unless the object is pushed
  double unchecked = 0.0;     // how far its points may go until that is found anew [m]
  Outline outline{};
  std::shared_ptr<const TornBody> torn{};    // null where it is whole
  std::vector<int> slot_of_host{};           // of a torn object: `slot` without particles at tears

  // Sets `way` to the mean displacement of its particles, and `stir` by the largest one relative to it, or more.
  void has_moved(const Vec3 &mean, double most) { way = mean, stir = body->leverage() * most; }
  // To be called when it has new lists: the places of its particles then.
  void find_outline(const PaddedVec3 *place);
  // To be called when it has moved.
  void find_crushed(const PaddedVec3 *place);

  bool is_rigid() const { return body->frame().has_value(); }
  // The same as `slot`, for its cells as they push at points of others.
  const std::vector<int> &host_slots() const { return torn ? slot_of_host : slot; }
  void find_host_slots();
  PointCarriers carriers_of(int point) const { return torn ? torn->carriers_of(point) : body->carriers_of(point); }
  BodyCarriers all_carriers() const { return torn ? torn->all_carriers() : body->all_carriers(); }
  // Whether a point is carried otherwise, or stands for another area, than by `before`, null where the object was whole.
  bool has_changed(int point, const TornBody *before) const;
  const double *areas() const { return torn ? torn->areas() : body->areas(); }
  // Whether the surface around a point has no normal: its cell is torn.
  bool faces_all(int point) const { return body->is_line() || (torn && torn->is_replaced(point)); }
  const Spot<double> &rigid_at(const Moment &at) const { return at.is_before ? rigid_before : rigid; }
  // Corners of the box around a rigid body.
  std::array<Vec3, 8> corners() const
  {
    std::array<Vec3, 8> found;
    const Vec3 &low = body->least(), &high = body->most();
    for (int c = 0; c < 8; ++c)
      found[c] = rigid.x + rigid.to_space({c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z});
    return found;
  }

  // Whether all particles that carry a point are here, and those that carry the centre of its area.
  bool has_point(int point) const
  {
    const PointCarriers by = carriers_of(point);
    return by.first < by.middle && are_here(by.first, by.last);
  }
  bool has_place_of(int point) const    // without the centre
  {
    const PointCarriers by = carriers_of(point);
    return by.first < by.middle && are_here(by.first, by.middle);
  }
  PointsTask points_at(const PaddedVec3 *at) const { return {all_carriers(), areas(), slot.data(), at}; }
  Vec3 place_by(const PointCarriers &by, const PaddedVec3 *at) const { return weighted_sum(by.first, by.middle, at); }
  Vec3 place_of(int point, const PaddedVec3 *at) const { return place_by(carriers_of(point), at); }
  // From the point to the centre of its area.
  Vec3 shift_of(int point, const PaddedVec3 *at) const
  {
    const PointCarriers by = carriers_of(point);
    return by.middle == by.last ? Vec3{} : weighted_sum(by.middle, by.last, at) - weighted_sum(by.first, by.middle, at);
  }
  void push_point(int point, const Vec3 &force, PaddedVec3 *on) const
  {
    const PointCarriers by = carriers_of(point);
    push(by.first, by.middle, force, on);
  }
  void push_centre(int point, const Vec3 &force, PaddedVec3 *on) const
  {
    const PointCarriers by = carriers_of(point);
    by.middle < by.last ? push(by.middle, by.last, force, on) : push(by.first, by.middle, force, on);
  }
  // Whether contacts of `other`, an object of the same id, have the same points.
  bool has_points_of(const ContactObject &other) const
  { return first_tag == other.first_tag && (body == other.body || *body == *other.body); }

 private:
  bool are_here(const PointCarrier *first, const PointCarrier *last) const
  {
    if (is_rigid()) return slot[0] >= 0;
    return std::all_of(first, last, [this](const PointCarrier &one) { return slot[one.slot] >= 0; });
  }
  Vec3 weighted_sum(const PointCarrier *one, const PointCarrier *last, const PaddedVec3 *at) const
  {
    Vec3 x = one->weight * at[slot[one->slot]].value;
    while (++one < last) x += one->weight * at[slot[one->slot]].value;
    return x;
  }
  void push(const PointCarrier *one, const PointCarrier *last, const Vec3 &force, PaddedVec3 *on) const
  {
    for (; one < last; ++one) on[slot[one->slot]].value += one->weight * force;
  }
};

// Upper bound of how much two objects have come nearer in this step.
inline double nearer(const ContactObject &a, const ContactObject &b)
{
  const Vec3 together = a.way - b.way;
  return std::sqrt(dot(together, together)) + a.stir + b.stir;
}

// The same of an object and a plane that faces along `normal`, and went this way.
inline double nearer(const ContactObject &a, const Vec3 &normal, const Vec3 &way_of_plane)
{ return a.stir - dot(normal, a.way - way_of_plane); }

// Energies, heat and counts of contacts in a step, and since the beginning.
struct ContactAccount {
  double energy = 0.0, stick_energy = 0.0;          // now [J]
  int touching = 0;                                 // points, now
  double heat = 0.0, damped = 0.0, let_go = 0.0;    // since the beginning [J]
  double work = 0.0;                                // of surfaces and planes that move, since the beginning [J]
  double deepest = 0.0;                             // in this run [m]
  double looks = 0.0;                               // at points of objects without a contact, since the beginning

  void begin_step() { energy = stick_energy = 0.0, touching = 0; }
  // Adds the account of some contacts in this step.
  void add(const ContactAccount &some)
  {
    energy += some.energy;
    stick_energy += some.stick_energy;
    touching += some.touching;
    heat += some.heat;
    damped += some.damped;
    let_go += some.let_go;
    work += some.work;
    deepest = std::max(deepest, some.deepest);
    looks += some.looks;
  }
};

// Positions and forces of all particles that contacts may need, by slots.
class ContactArrays {
 public:
  const ContactKernels *kernels = nullptr;    // null: contacts one at a time, with the same bits

  // For this number of particles from now on, with zero forces; their places, now and before, must then be set.
  void renew(std::size_t particles)
  {
    place_rows.swap(old_rows);
    rows_before.swap(old_rows_before);
    place_rows.resize(particles + 1);
    rows_before.resize(particles + 1);
    force_rows.resize(particles);
  }
  // The places become those of the step before; new ones must then be set.
  void keep_places() { place_rows.swap(rows_before); }
  std::size_t size() const { return force_rows.size(); }
  bool taken = true;    // all forces are 0: who took them has cleared them
  void clear_forces(int from, int to)
  {
    if (!taken) std::fill(force_rows.begin() + from, force_rows.begin() + to, PaddedVec3{});
  }
  PaddedVec3 *place() { return place_rows.data() + 1; }    // slot -1, of a particle that is not here, may be read
  const PaddedVec3 *place() const { return place_rows.data() + 1; }
  PaddedVec3 *place_before() { return rows_before.data() + 1; }    // in the step before
  const PaddedVec3 *place_before() const { return rows_before.data() + 1; }
  // The places before renew() was called, and those of the step before.
  const PaddedVec3 *place_of_old_slots() const { return old_rows.data() + 1; }
  const PaddedVec3 *place_before_of_old_slots() const { return old_rows_before.data() + 1; }
  Moment now() const { return {place(), false}; }
  Moment before() const { return {rows_before.data() + 1, true}; }
  PaddedVec3 *force() { return force_rows.data(); }
  const PaddedVec3 *force() const { return force_rows.data(); }
  std::size_t bytes() const
  {
    return (place_rows.capacity() + rows_before.capacity() + old_rows.capacity() + old_rows_before.capacity() +
            force_rows.capacity()) *
           sizeof(PaddedVec3);
  }

 private:
  std::vector<PaddedVec3> place_rows = std::vector<PaddedVec3>(1), rows_before = place_rows, old_rows, old_rows_before,
                          force_rows;
};

// The points of an object whose particles are here, by the places that the cells that carry them had when lists were made.
class PointFinder {
 public:
  PointFinder(const ContactObject &owner, const ContactArrays &arrays);
  // Ascending numbers of all points in a zone that act on flat surfaces, or on others, and of some beside it; the points of
  // `contacts` are among them.
  template <class Contact> std::vector<int> inside(const Zone &zone, bool on_flat, const std::vector<Contact> &contacts) const
  {
    std::vector<std::uint64_t> marked((owner.body->points().size() + 63) / 64, 0);
    const auto mark = [&marked](int point) { marked[point / 64] |= std::uint64_t{1} << point % 64; };
    for (const auto &[c, box] : cells) {
      const PointCell &cell = owner.body->point_cells()[c];
      if (!zone.meets(box)) continue;
      const auto [first, end] = owner.body->acting(cell, on_flat);
      for (int n = first; n < end; ++n) mark(owner.body->points_by_cell()[n]);
      if (!owner.torn) continue;    // points of single particles act on all shapes
      for (int n = cell.first; n < cell.last; ++n)
        if (const int point = owner.body->points_by_cell()[n]; owner.torn->is_replaced(point)) mark(point);
    }
    for (const Contact &one : contacts) mark(one.point);
    std::vector<int> found;
    for (std::size_t word = 0; word < marked.size(); ++word)
      for (std::uint64_t left = marked[word]; left; left &= left - 1)
        found.push_back(static_cast<int>(64 * word) + __builtin_ctzll(left));
    return found;
  }
  // The lowest coordinate of the points along a direction.
  double least_along(const Vec3 &direction) const;

 private:
  const ContactObject &owner;
  const ContactArrays &arrays;
  std::vector<std::pair<int, Box>> cells;    // cells of the body, and boxes around those of their points that are here
};

// Cells on an object's surface, from which a search begins. They are found by the places that they had when this was made.
class OuterCells {
 public:
  // The cell whose middle is nearest to a place.
  struct NearestCell {
    std::array<int, 3> cell = {-1, -1, -1};    // -1 if none was within SEARCHED cells
    double away = 0.0, others = 0.0;           // of its middle, and of all middles but those around it, or less [m]
  };
  OuterCells(const ContactObject &owner, const ContactArrays &arrays);
  // With particles at `place`.
  NearestCell nearest(const Vec3 &x, const PaddedVec3 *place) const;
  std::size_t bytes() const { return cells.capacity() * sizeof cells[0]; }
  static constexpr double SEARCHED = 5.0;

 private:
  struct OuterCell {
    std::array<int, 3> at;
    int low, high;    // slots of two opposite corners
    int number;       // of two that are equally near the lower one counts
  };
  std::vector<OuterCell> cells;    // in the order of the grid
  double spacing;
  Grid grid;
};

// The same, made when it is first asked for, by whichever thread does so.
class LateOuterCells {
 public:
  const OuterCells &of(const ContactObject &owner, const ContactArrays &arrays)
  {
    std::call_once(made, [&] { cells.emplace(owner, arrays); });
    return *cells;
  }
  std::size_t bytes() const { return cells ? cells->bytes() : 0; }

 private:
  std::once_flag made;
  std::optional<OuterCells> cells;
};

}    // namespace mdanim
