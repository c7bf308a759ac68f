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
  // From what is left of the records of bodies, if they have one. Contact has to be told once glue is there.
  void read(std::vector<std::optional<ByteReader>> &records);

 private:
  // A body, or all that are glued together, moves as one, and has the number of the first.
  bool is_first(std::size_t body) const { return glue.glued.first_of(static_cast<int>(body)) == static_cast<int>(body); }
  const RigidBody &whole_of(std::size_t body) const
  { return glue.glued.holds(body) ? glue.glued.whole(static_cast<int>(body)).body : bodies[body]; }
  double size_of(std::size_t body) const;
  double acceleration_of(std::size_t body) const;
  bool is_calm(std::size_t body) const;
  void set_calm(std::size_t body, double calm);
  // Calls visit(n) for each of them.
  template <class Visit> void each_of(std::size_t body, const Visit &visit) const
  {
    if (!glue.glued.holds(body)) return visit(body);
    for (const int n : glue.glued.whole(static_cast<int>(body)).pieces) visit(static_cast<std::size_t>(n));
  }
  int sleepers() const;

  LAMMPS_NS::LAMMPS *lmp;
  RigidTouching &touching;
  RigidGlue &glue;
  std::vector<RigidBody> &bodies;
  double speed = 0.0, acceleration = 0.0, time = 0.0;    // the rule
  double stilled = 0.0;
};

}    // namespace mdanim
