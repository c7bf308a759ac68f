// SPDX-License-Identifier: GPL-2.0-only
// Contact of rigid bodies by features for fix mdanim/rigid: words of the command, shapes of bodies, forces of contact.

#pragma once

#include "lammps/fix_base.h"
#include "lammps/keywords.h"
#include "lammps/moving_planes.h"
#include "lammps/object_table.h"
#include "records/byte_reader.h"
#include "records/state_records.h"
#include "rigid/body.h"
#include "rigid/glued_bodies.h"
#include "rigid/rigid_contact.h"
#include "rigid/shapes_file.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {
class FixMdanimDrive;
}

namespace mdanim {

std::string name_of_record(const StateKey &key);    // begins messages

class RigidTouching {
 public:
  static constexpr int NO_SHAPE = -1;     // of a body that does not touch by features
  static std::vector<Keyword> words();    // of the command
  explicit RigidTouching(LAMMPS_NS::LAMMPS *lmp) : lmp(lmp), moving(lmp) {}

  // Reads a word with its values, where it is one of words().
  void read_word(int iarg, char **arg);
  // Refuses words that do not belong together, and shapes that contact does not know on each other.
  void check() const;
  bool is_on() const { return contact.settings.objects || !contact.settings.planes.empty(); }

  // Outputs of the fix that are of contact.
  std::vector<Output> outputs();

  // Looks up the fix that drives some of the shapes, if there is one; to be called before each run. `fix` begins messages.
  void init(const std::string &fix);

  // Takes bodies that have just been made, but for those that are laid aside, or have come with these poses of their shapes.
  // `fix` begins messages.
  void make(const std::string &fix, const ObjectTable &objects, const std::vector<RigidBody> &bodies);
  void take(const std::string &fix, const ObjectTable &objects, const std::vector<RigidBody> &bodies,
            std::vector<Pose> in_bodies);
  const Pose &pose(int body) const { return poses[body]; }
  const std::map<int, GivenShape> &given_shapes() const { return shapes; }    // by molecule IDs

  // Tells contact how some pieces are glued now.
  void glue(const GluedBodies &glued, const std::vector<int> &pieces);
  // The same of pieces that came apart, at the end of a step, after which pushes are others (RigidContact::change).
  double unglue(const GluedBodies &glued, const std::vector<int> &pieces);

  // Finds forces dt after the last step; dt = 0 at the setup of a run.
  void step(const std::vector<RigidBody> &bodies, double dt);
  struct Push {
    Vec3 force, torque;
  };
  Push push(int body) const
  {
    if (solid_of[body] == NO_SHAPE) return {};
    return {contact.solid(solid_of[body]).force, contact.solid(solid_of[body]).torque};
  }
  void set_push(int body, const Push &push)
  {
    if (solid_of[body] != NO_SHAPE) contact.set_force(solid_of[body], push.force, push.torque);
  }
  // A body that is laid aside neither moves nor touches.
  void lay_aside(int body, bool aside)
  {
    if (solid_of[body] != NO_SHAPE && contact.lay_aside(solid_of[body], aside)) is_current = false;
  }
  int solid(int body) const { return solid_of[body]; }

  LAMMPS_NS::FixMdanimDrive *guide() const { return drive; }

  // Driven shapes of which no particle is driven any more are laid aside, too.
  void lay_driven_aside();
  // Driven shapes: a record of the push on each, and the work of moving them against it since the fix was made.
  bool is_driven(int id) const;
  void put_driven(std::int64_t version, StateRecords &records) const;
  void read_driven(std::int64_t version, const StateRecords &records);
  double work = 0.0;
  // This work, with that of planes and of surfaces that move.
  double taken() const { return work + contact.account.work; }

  // Contacts from the records of pairs, and at planes from what is left of those of bodies. Throws std::runtime_error.
  void read_contacts(const StateRecords &records, std::int64_t version, std::vector<std::optional<ByteReader>> &at_planes);

  RigidContact contact;
  bool is_current = false;    // whether pushes are those of the present places and velocities

 private:
  struct DrivenSolid {
    int id, solid;
    Pose start;          // at time 0 of its drive
    Vec3 way, turned;    // of the last step
    Push push;
  };
  void place_all(const std::vector<RigidBody> &bodies, bool settled);    // those that are settled, too
  void place_driven();
  void move_planes();
  void count_work(bool moves);
  void read_plane(int iarg, char **arg);
  std::pair<int, int> read_two(int iarg, char **arg) const;
  void read_pair(int iarg, char **arg);

  LAMMPS_NS::LAMMPS *lmp;
  MovingPlanes moving;
  std::map<int, GivenShape> shapes;    // by molecule IDs
  std::vector<Pose> poses;             // of bodies
  std::vector<int> solid_of;           // number among the bodies of contact
  std::vector<DrivenSolid> driven;
  std::string drive_id;
  LAMMPS_NS::FixMdanimDrive *drive = nullptr;
  bool has_file = false;
};

}    // namespace mdanim
