// SPDX-License-Identifier: GPL-2.0-only
// All objects in contact, the pairs of them that may touch, and their forces. Knows neither LAMMPS nor ranks: its input is the
// same on all of them, and so is its output.

#pragma once

#include "contact/contact_field.h"
#include "contact/contact_object.h"
#include "contact/plane_field.h"
#include "geometry/boxes.h"
#include "threads/team.h"

#include <array>
#include <map>
#include <utility>
#include <vector>

namespace mdanim {

// Friction and damping of a pair of objects, in place of those of their materials.
struct PairLaw {
  double friction, damping;
};

struct ContactSettings {
  bool objects = false;      // whether they touch each other
  double stiffness = 1.0;    // f
  double damping = 0.0;      // beta of pairs with friction
  std::vector<ContactPlane> planes;
  std::map<std::pair<int, int>, PairLaw> pairs;    // by ids, the lower one first
};

// A particle of an object: the number of the object in the world and that of the particle in the object.
struct ContactParticle {
  int object, node;
  bool operator<(const ContactParticle &other) const
  { return object != other.object ? object < other.object : node < other.node; }
};

// Coordinates of particles: all x, all y, all z.
using Coordinates = std::array<const double *, 3>;

class ContactWorld {
 public:
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

  // --- lists ---
  // Sets boxes of all objects. No object comes nearer to another than by `skin` until lists are made again.
  void look_ahead(const std::vector<Box> &boxes, double skin);
  // Two numbers for each pair whose boxes meet, each to be replaced by its minimum over all ranks after see() has been called
  // with all particles.
  std::vector<double> ends() const { return std::vector<double>(2 * near_pairs.size(), Box::FAR); }
  void see(int object, const Vec3 &x, std::vector<double> &ends) const;
  // Drops pairs that are apart along the line between their middles.
  void narrow(const std::vector<double> &ends);
  // How far every particle may go until two objects, or an object and a plane, can touch; at most 32 times `skin`; 0 where some
  // already can.
  double distance_apart() const { return apart; }
  bool is_idle() const { return near_pairs.empty() && near_planes.empty(); }
  int pairs() const { return static_cast<int>(near_pairs.size()); }
  // Whether a particle of an object may take part in contacts.
  bool needs(const ContactParticle &particle, const Vec3 &x) const;
  // Sets the particles that may, ascending, and their places.
  void list(const std::vector<ContactParticle> &particles, const Coordinates &places);
  // Forgets all points except those in contact: to be called before list() at the setup of a run.
  void forget();

  // --- steps ---
  // Sets kernels and threads. Null: contacts one at a time, with the same bits. The number of threads changes no bit either.
  void use(const ContactKernels *kernels, const Threads &now)
  {
    arrays.kernels = kernels;
    threads = now;
  }
  // Computes the forces with all particles at these places. dt = 0 at the setup of a run: nothing changes.
  void step(const Coordinates &places, double dt);
  const PaddedVec3 *forces() const { return arrays.force(); }
  // Whether some force on an object's particles is not 0.
  bool is_pushed(int object) const { return all[object].is_pushed; }

  ContactAccount account;
  Vec3 force_on_planes() const;

  // Contacts of two objects by their ids, those of points of the lower one first, and of an object with all planes; only pairs
  // and objects with contacts.
  using PairKey = std::pair<int, int>;
  using PairContacts = std::map<PairKey, std::pair<std::vector<FieldContact>, std::vector<FieldContact>>>;
  using PlaneContacts = std::map<int, std::vector<PlaneContact>>;
  PairContacts pair_contacts() const;
  PlaneContacts plane_contacts() const;
  // Replaces all contacts by these.
  void restore(const PairContacts &pairs, const PlaneContacts &planes);
  // Memory of pairs of objects and of objects at planes, with the points near by; and of the places of particles and forces on
  // them.
  std::size_t bytes_of_fields() const;
  std::size_t bytes_of_particles() const;

 private:
  struct Both {
    ContactField lower, higher;    // points of the object of the lower id, and of the other
  };
  // A pair of objects that may touch, by their numbers, and the zones of their particles near each other.
  struct NearPair {
    int a, b;
    Zone of_a, of_b;    // `across` points at the other
  };
  // A zone in which particles of an object may take part in contacts.
  struct Sight {
    Zone zone;
    int end;    // place in ends() of the other object of the pair; -1 for a plane
  };
  // A field of points of object a against object b, or a plane.
  struct Active {
    int a, b;
    ContactField *field;
    PlaneField *plane;
    const Zone *of_host;       // for lists
    bool has_something;        // whether it has forces to add in this step,
    ContactAccount of_step;    // and the account of these
  };
  // A field with forces to add in this step, and the number of fields that come before it on each of its objects.
  struct Turn {
    Active *field;
    int on_a, on_b;
  };
  double range(int a, int b) const;
  void find_sights();
  ContactLaw law(const ContactObject &owner, double density, double kappa, double friction, double damping) const;
  struct LawsOfPair {
    ContactLaw lower, higher;
  };
  LawsOfPair laws_of_pair(int a, int b) const;
  ContactLaw law_at_plane(int n) const;
  void renew_laws();
  Both new_pair(int a, int b);
  PlaneField new_plane(int n, int plane);
  bool can_touch(int a, int b) const { return movable[a] || movable[b]; }
  bool near_plane(const Box &box, const ContactPlane &plane, double gap) const;
  void move_to(const Coordinates &places);
  void find_points();
  void look(Active &one, double dt);
  void look_and_work_ahead(double dt);
  void add_forces(Active &one, double dt);
  void list_turns();
  void add_forces_side_by_side(double dt);
  void clear_forces(ContactObject &one);

  std::vector<ContactObject> all;
  std::vector<char> movable;
  std::map<int, int> number_of;    // of ids
  double skin = 0.0, widest = 0.0, apart = 0.0;
  bool listed = false;
  std::vector<NearPair> near_pairs;
  std::vector<std::pair<int, int>> near_planes;              // numbers of the object and of the plane
  std::vector<std::vector<Sight>> sights;                    // of each object
  std::map<PairKey, Both> fields;                            // by ids
  std::map<std::pair<int, int>, PlaneField> plane_fields;    // by id and plane
  std::vector<Active> active;                                // the fields of a step, in the order of sums,
  std::vector<long> costs = {0};                             // and the cost of all before each of them; at the end, that of all
  std::vector<Turn> turns;                                   // in an order in which no field waits for a later one
  std::vector<std::vector<Turn>> turns_after;                // fields that wait for chains of n others, for each n
  Threads threads;
  ContactArrays arrays;
};

}    // namespace mdanim
