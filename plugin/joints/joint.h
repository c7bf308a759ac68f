// SPDX-License-Identifier: GPL-2.0-only
// A joint: springs between two patches, and what drives, brakes and stops the motion that they leave free.
//
// With p the place of the joint in either patch and F the maps of their directions,
//   U = K/2 |g|^2 + K L^2/2 sum_j |F_A e_j - F_B e_j|^2,   g = p_A - p_B (of a slider its part across the axis F_B n).
// K of a slider is divided by 1 + l q + l' q^2, so that it has the same rate wherever it is: a body on a long lever gives more.
// A ball holds no direction e_j, a hinge its axis n (two springs of K/2 at +-L on it), a weld and a slider three. Forces are the
// derivatives of U, which does not change when all is turned: the angular momentum of both bodies stays as their momentum does.
// Angle and way are those of A seen from B, 0 at the start.

#pragma once

#include "joints/directions.h"
#include "joints/hinge_angle.h"
#include "joints/law.h"
#include "joints/patch.h"
#include "joints/words.h"

#include <cstdint>
#include <vector>

namespace mdanim {

struct JointEnd {
  std::vector<std::int64_t> tags;    // of the members of the patch, ascending; from the lowest of the object in records
  Patch patch;
  Vec3 d;                // the place of the joint, from the centre of the patch
  bool moves = false;    // whether forces act on it

  // Mobilities of the patch; 0 where no force acts.
  double mobility() const { return moves ? patch.mobility(d) : 0.0; }
  double mobility_of_direction(const Vec3 &e) const { return moves ? patch.mobility_of_direction(e) : 0.0; }
};

// Energy that joints hold, and that they have turned into heat or taken from motors.
struct JointAccount {
  double heat = 0.0, work = 0.0;
};

class Joint {
 public:
  struct Loads {
    PatchLoad a, b;
  };
  // Part of the state that changes in each step.
  struct Past {
    double q = 0.0;    // angle over all turns, way, length
    DriveState motor, brake;
    double depth = 0.0;    // in a stop
    std::int64_t broken = 0, began = 0;
  };
  // For the work of the next step: loads of dashpots, friction and stops, and of the motor, and where both patches are.
  struct Spending {
    Loads losses, motor;
    Vec3 c_a, c_b;
    Matrix3 F_a, F_b;
  };
  // Its forces and motion now.
  struct Reading {
    double force = 0.0, torque = 0.0, rate = 0.0, driving = 0.0, gap = 0.0, energy = 0.0;
    Vec3 at_a, at_b;
  };

  // `length`: of a spring at the start. ftm2v: acceleration for a force of 1 on a mass of 1. Throws std::runtime_error when the
  // patches do not have the place, the axis or the directions of the joint.
  Joint(JointWords words, JointEnd a, JointEnd b, double length, double ftm2v);

  const JointWords &words() const { return given; }
  const JointEnd &a() const { return end_a; }
  const JointEnd &b() const { return end_b; }
  double rest_length() const { return own_length; }
  const Past &past() const { return before; }
  const Spending &spending() const { return spent_before; }
  bool spends() const { return law.c > 0.0 || given.has_servo(); }    // otherwise spending() stays zero
  void set_past(const Past &past, const Spending &spending) { before = past, spent_before = spending; }
  void forget();    // all that was since the start
  const Reading &reading() const { return now; }
  bool is_broken() const { return before.broken != 0; }
  double way() const { return before.q; }

  // Loads on both patches after a step of dt, whose velocities are those of the middle of the step.
  Loads step(const PatchMotion &a, const PatchMotion &b, double dt, JointAccount &account);
  // The same before a step, when no time has passed; `anew`: forces of the last step are forgotten.
  Loads begin(const PatchMotion &a, const PatchMotion &b, double dt, bool anew);

 private:
  // One of both ends in a step.
  struct Side {
    const Patch &patch;
    const Vec3 &d;            // the place of the joint in it
    const Vec3 *direction;    // those that are held
    const PatchMotion &motion;
    PatchLoad &springs, &losses, &motor;
    Vec3 place() const { return motion.point(d); }
    Vec3 velocity() const { return motion.velocity(d); }
  };
  // Time that has passed, and that of the step.
  struct Time {
    double passed, step;
  };
  // Forces along the free coordinate on A.
  struct Driving {
    double losses = 0.0, motor = 0.0;
  };
  void choose_laws(double ftm2v);
  void load_before();
  Loads find(const PatchMotion &a, const PatchMotion &b, const Time &time, Past &past, Spending &spending, JointAccount &account);
  void pull(const Side &a, const Side &b, Past &past);
  void hold(const Side &base, const Side &moving, const Time &time, Past &past);
  Vec3 damp(const Side &base, const Side &moving, double c, const Vec3 &free) const;
  void turn(const Side &base, const Side &moving, const Time &time, Past &past);
  void brake(const Side &base, const Side &moving, Vec3 &torque) const;
  Driving drive(double rate, const Time &time, Past &past);

  JointWords given;
  JointEnd end_a, end_b;
  double own_length = 0.0;
  JointDirections directions;
  SpringLaw law, turning, servo, stop;
  double servo_mobility = 0.0, stop_mobility = 0.0;
  double lever[2] = {0.0, 0.0};    // of a slider: its mobility at the way q is that at the start times 1 + lever q
  Vec3 place_in_a;                 // the place of the joint, moved by what the joint bears at the start
  Vec3 turned_in_a[3];             // those that are held, in A, turned by what the joint bears at the start
  Past before;
  Spending spent_before;
  Reading now;
};

}    // namespace mdanim
