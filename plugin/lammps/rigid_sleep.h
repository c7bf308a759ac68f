// SPDX-License-Identifier: GPL-2.0-only
// Rigid bodies that lie still: they stay where they are, without motion, until what acts on one of them is out of balance.
//
// A body is calm in a step if it touches something that does not move, and no point of it is faster, or accelerated more, than
// the rule says. Having been calm for a time it sleeps. It wakes where the forces on it, of contact with what is awake and of all
// else, no longer balance: so a tower that loses its foot wakes from below, body by body, as fast as they push each other.

#pragma once

#include "lammps/fix_base.h"
#include "lammps/keywords.h"
#include "lammps/rigid_glue.h"
#include "lammps/rigid_touching.h"
#include "records/byte_reader.h"
#include "records/byte_writer.h"
#include "rigid/body.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace mdanim {

class RigidSleep {
 public:
  RigidSleep(LAMMPS_NS::LAMMPS *lmp, RigidTouching &touching, RigidGlue &glue, std::vector<RigidBody> &bodies)
      : lmp(lmp), touching(touching), glue(glue), bodies(bodies)
  {
  }

  static Keyword word() { return {"sleep", "SPEED ACCELERATION TIME"}; }
  void read_word(int iarg, char **arg);
  std::vector<Output> outputs();
  bool is_on() const { return time > 0.0; }
  double taken() const { return stilled; }    // energy of motion, in units of mass times velocity squared

  void wake_all();
  // Tells contact who sleeps, after it has taken the bodies.
  void tell_contact();
  // At the end of a step, with all forces: wakes those on which these do not balance.
  void wake_some();
  // With the velocities of whole steps: puts to sleep what has been calm for long enough. `half_dt` and `drag` are as in
  // RigidBody.
  void put_some_to_sleep(double half_dt, const std::vector<double> &drag);

  // Part of the record of a body.
  void put(std::size_t body, ByteWriter &writer) const;
  // From what is left of the records of bodies, if they have one; tells contact, which has taken the bodies.
  void read(std::vector<std::optional<ByteReader>> &records);

 private:
  double size_of(std::size_t body) const;
  double acceleration_of(std::size_t body) const;
  bool is_calm(std::size_t body) const;
  void tell(std::size_t body);
  int sleepers() const;

  LAMMPS_NS::LAMMPS *lmp;
  RigidTouching &touching;
  RigidGlue &glue;
  std::vector<RigidBody> &bodies;
  double speed = 0.0, acceleration = 0.0, time = 0.0;    // the rule
  double stilled = 0.0;
};

}    // namespace mdanim
