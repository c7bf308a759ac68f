// SPDX-License-Identifier: GPL-2.0-only
// All objects in contact, the pairs of them that may touch, and their forces. Knows neither LAMMPS nor ranks: its input is the
// same on all of them, and so is its output.

#pragma once

#include "contact/contact_field.h"
#include "contact/contact_laws.h"
#include "contact/contact_object.h"
#include "contact/field_sums.h"
#include "contact/near_objects.h"
#include "records/state_records.h"
#include "threads/team.h"

#include <array>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

namespace mdanim {

// Coordinates of particles: all x, all y, all z.
using Coordinates = std::array<const double *, 3>;

class ContactWorld {
 public:
  ContactWorld() = default;
  ContactWorld(const ContactWorld &) = delete;    // its parts know its objects
  ContactWorld &operator=(const ContactWorld &) = delete;

  ContactSettings settings;

  // Sets the objects, by ascending ids; `moves` says for each whether some particle can move. Contacts stay with the ids of their
  // objects and get the law of the present materials. Those of an object that has another body or other particles end. Must be
  // followed by list().
  void take(std::vector<ContactObject> now, std::vector<char> moves);
  const ContactObject *with_id(int id) const;    // null for none
  // The first of these objects whose contacts belong to another body or to other particles; null for none.
  const ContactObject *misfit(const std::vector<ContactObject> &now) const;
  // Whether lists belong to the present objects.
  bool is_listed() const { return listed; }
  int objects() const { return static_cast<int>(all.size()); }
  const ContactObject &object(int n) const { return all[n]; }

  // Places rigid objects: the particles of their frames, of all these objects one after the other; and sets their boxes.
  void place_rigid(const std::vector<Vec3> &frames, std::vector<Box> &boxes);

  // Sets the particles that may take part in contacts, ascending, and their places; `near` must have looked ahead before.
  void list(const std::vector<ContactParticle> &particles, const Coordinates &places);
  // Forgets lists and all points except those in contact: to be called before list() at the setup of a run.
  void forget();

  // Sets links of objects that are gone: the numbers of particles at their ends, two for each, by ids of objects. In a run, with
  // all particles at these places, contacts of points that are replaced end, and list() must follow; at its setup, null, they
  // have ended.
  using TornEnds = std::map<int, std::vector<int>>;
  void tear(const TornEnds &ends, const Coordinates *places);

  // Sets kernels and threads. Null: contacts one at a time, with the same bits. The number of threads changes no bit either.
  void use(const ContactKernels *kernels, const Threads &now) { arrays.kernels = kernels, threads = now; }
  // Computes the forces with all particles at these places. dt = 0 at the setup of a run: nothing changes.
  void step(const Coordinates &places, double dt);
  const PaddedVec3 *forces() const { return arrays.force(); }
  PaddedVec3 *take_forces() { return arrays.taken = true, arrays.force(); }    // for one who clears all that are not 0
  // Whether some force on an object's particles is not 0.
  bool is_pushed(int object) const { return all[object].is_pushed; }
  Vec3 force_on_planes() const;

  // For passes, see FieldSums. Until points are taken back no step is to be computed here.
  std::vector<PointsAtPlane> hand_over_planes() const { return sums.hand_over(); }
  void take_back_planes(const std::vector<PointsAtPlane> &points) { sums.take_back(points, account); }

  // Contacts as records of pairs of objects, (a, b), and of objects at planes, (a, 0).
  StateRecords records() const;
  // Replaces all contacts by these. Throws std::runtime_error, and changes nothing, where they are not of the present objects.
  void restore(const StateRecords &records);

  // Memory of pairs of objects and of objects at planes, with the points near by; and of the places of particles and forces on
  // them.
  std::size_t bytes_of_fields() const;
  std::size_t bytes_of_particles() const;

 private:
  // Points of an object against another one or a plane, in the order of sums. Objects are given by ids, the lower one of a pair
  // first, a plane by its number.
  struct FieldKey {
    bool at_plane;
    int first, second;
    bool of_second;    // the points
    bool operator<(const FieldKey &other) const { return tied() < other.tied(); }
    std::tuple<bool, int, int, bool> tied() const { return {at_plane, first, second, of_second}; }
    StateKey record() const { return {first, at_plane ? 0 : second}; }
  };
  using Fields = std::map<FieldKey, std::unique_ptr<ContactField>>;

  int owner_of(const FieldKey &key) const { return number_of.at(key.of_second ? key.second : key.first); }
  int host_of(const FieldKey &key) const
  { return key.at_plane || key.of_second ? number_of.at(key.first) : number_of.at(key.second); }
  ContactLaw law_of(const FieldKey &key) const;
  std::unique_ptr<ContactField> make(const FieldKey &key);
  template <class Field, class Row> void put(Fields &into, const FieldKey &key, std::vector<Row> rows);
  Fields read(const StateRecords &records);
  void drop_lists();
  void move_to(const Coordinates &places);
  void list_fields();
  void find_points();

  std::vector<ContactObject> all;
  std::vector<char> movable;
  std::vector<int> torn_now;                  // objects, until there are lists
  std::map<int, int> number_of;               // of ids
  bool listed = false, has_before = false;    // lists are there; they have been made since the last step, and know its places
  std::map<FieldKey, std::vector<LossOfPoint>> losses;    // that the account does not hold yet
  Fields fields;
  FieldSums sums;
  Threads threads;
  ContactArrays arrays;

 public:
  const ContactAccount &booked();    // with what points have lost since it was asked for last
  ContactAccount account;
  NearObjects near{settings, all, movable};
};

}    // namespace mdanim
