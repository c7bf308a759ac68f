// SPDX-License-Identifier: GPL-2.0-only
// All rigid bodies in contact with each other and with planes, by features: corners, edges, moving points of round shapes. Knows
// neither LAMMPS nor ranks: its input is the same on all of them, and so is its output.

#pragma once

#include "records/byte_reader.h"
#include "records/byte_writer.h"
#include "rigid/body.h"
#include "rigid/near_solids.h"
#include "rigid/rigid_beds.h"
#include "rigid/touch.h"
#include "rigid/watched_pairs.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace mdanim {

struct RigidContactSettings {
  bool objects = false;      // whether bodies touch each other
  double frequency = 0.0;    // Omega of the rule of stiffness, k = Omega^2 / (lambda_a + lambda_b) [1/s]
  double onset = 0.0;        // eps [m]
  std::vector<SolidPlane> planes;
  // Friction and damping of pairs, by ids, the lower one first; of a body and plane k the second is -1 - k.
  std::map<std::pair<int, int>, Material> pairs;
  std::map<std::pair<int, int>, double> rolling;    // the same of what resists rolling, the arm of its torque
  std::set<std::pair<int, int>> excluded;           // ids of pairs that never touch, the lower one first
  std::map<int, Vec3> belts;                        // velocities at which surfaces run over bodies, by their ids
  bool sleeps = false;                              // whether bodies may be put to rest

  bool planes_stand() const
  {
    return std::none_of(planes.begin(), planes.end(), [](const SolidPlane &plane) { return plane.moves; });
  }
  TouchLaw law_of(const Solid &a, const Solid &b) const;
  TouchLaw law_at(const Solid &one, int plane) const;

 private:
  TouchLaw law_with(double yields, Material material, std::pair<int, int> ids) const;
};

class RigidContact {
 public:
  RigidContactSettings settings;
  TouchAccount account;

  // Sets the threads of steps. Their number changes no bit.
  void use(const Threads &now) { threads.use(now); }
  // Bodies by ascending ids. Their contacts, if any, end.
  void take(std::vector<Solid> now);
  int bodies() const { return static_cast<int>(solids.size()); }
  const Solid &solid(int n) const { return solids[n]; }
  int number_of(int id) const;    // -1 for none
  std::size_t near_pairs() const { return near.pairs.size(); }
  std::size_t bytes() const;
  const Threads &helpers() const { return threads.all(); }

  // Places a body that can move, before a step.
  void place(int n, const RigidBody &body);
  // Places one that is driven, with its velocities in the step that ends here.
  void place_driven(int n, const Vec3 &centre, const Matrix3 &turn, const Vec3 &velocity, const Vec3 &spin)
  { solids[n].put(centre, turn, velocity, spin); }
  void set_force(int n, const Vec3 &force, const Vec3 &torque) { solids[n].force = force, solids[n].torque = torque; }
  // A body that is laid aside touches nothing, and its contacts end. Returns whether this is new.
  bool lay_aside(int n, bool aside);
  // Says whether a body does not move, and whether it has not done so for some steps: between two that are settled nothing
  // changes.
  void rest(int n, bool asleep, bool settled);
  // Says which body a piece is glued into; `faces`: those of its shape that glue covers (see Polyhedron::cover), or none.
  void glue(int n, int whole, const Carrier &carrier, const std::vector<char> &faces);
  // Finds what bodies that are glued together bear more than contact gives them (RigidBeds::spread).
  PieceMotions spread_over_beds() { return beds.spread(solids, near.pairs, settings.planes, at_plane, settings.onset); }
  // To be called after `glue`, at the end of a step: contacts of bodies that yield more than before, by their numbers and with
  // what they yielded, get softer, and those that touch from then on do so without a force. Forces on these, and on all that they
  // touch, are found again. Returns the energy that contacts lose.
  double change(const std::map<int, double> &yielded);
  // The account, with the energy of contacts, and how many there are, from what they remember.
  const TouchAccount &found();
  // Begins what the account tells of a run alone.
  void begin_account();
  // Finds the forces on bodies, dt after the last step; dt = 0 at the setup of a run.
  void step(double dt);

  // Contacts with planes of one body, and of a pair of bodies: what they remember.
  void put_at_planes(int n, ByteWriter &writer) const;
  void read_at_planes(int n, ByteReader &reader);
  // Calls visit(a, b, bytes) for each pair in contact.
  template <class Visit> void each_pair_record(const Visit &visit) const
  {
    for (const SolidPair &pair : near.pairs)
      if (!pair.touches.empty()) visit(pair.a, pair.b, record_of(pair));
  }
  void read_pair(int a, int b, ByteReader &reader);
  void forget();    // all contacts

 private:
  Bytes record_of(const SolidPair &pair) const;
  void touch_pair(const TouchStep &step, SolidPair &pair);
  void touch_plane(const TouchStep &step, std::vector<Touch> &touches, Solid &one, int plane);
  void push_more(const InBlow &one, const Vec3 &force);    // in this step
  void touch_counted(const TouchStep &step, SolidPair &pair);
  void touch(const TouchStep &step, int k, bool all);
  void touch_planes(const TouchStep &step, bool all);
  bool find_active(bool listed_anew);
  template <class Visit> void each_touch(const Visit &visit) const
  {
    for (const auto &of_plane : at_plane)
      for (const std::vector<Touch> &touches : of_plane) std::for_each(touches.begin(), touches.end(), visit);
    for (const SolidPair &pair : near.pairs) std::for_each(pair.touches.begin(), pair.touches.end(), visit);
  }

  std::vector<Solid> solids;
  TouchThreads threads;
  long touches_at_planes = 0, all_touches = 0;    // in the last step; those of two bodies count twice
  RigidBeds beds;
  NearSolids near;
  WatchedPairs watched;
  std::vector<int> active;    // pairs that are looked at where some bodies are settled, else all
  bool is_active_known = false;
  std::vector<char> unstirred;    // of bodies: settled, and so is all that is near
  RigidBeds::TouchesAtPlanes at_plane;
  // Forces on bodies from planes that move, in the last step, by planes and ids; none before the first one.
  std::map<std::pair<int, int>, std::optional<Vec3>> plane_push;
};

}    // namespace mdanim
