// SPDX-License-Identifier: GPL-2.0-only
// Joints as users write them.

#pragma once

#include "numbers/vec3.h"
#include "records/line_words.h"

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace mdanim {

enum class JointKind { WELD, BALL, HINGE, SLIDER, SPRING };

constexpr double WHOLE = std::numeric_limits<double>::infinity();    // a patch of all particles of a body
constexpr int WORLD = 0;                                             // in place of a molecule ID

// All values in LAMMPS's units.
struct JointWords {
  struct End {
    int object = WORLD;
    Vec3 at;
    double radius = WHOLE;    // of the patch
  };
  JointKind kind = JointKind::BALL;
  End a, b;
  Vec3 axis;
  std::optional<double> stiffness, frequency, arm, length;
  double damping = 0.0;
  std::optional<double> damping_ratio;
  struct Servo {
    double stiffness, damping;
  };
  std::optional<Servo> servo;
  struct Motor {
    double speed, most;    // most: infinite where there is no limit
  };
  std::optional<Motor> motor;
  double rise = HUGE_VAL;    // of the motor's speed in a unit of time
  struct StopSpring {
    double stiffness, damping, mobility;    // the latter of the free coordinate, force to acceleration
  };
  std::optional<StopSpring> stop;
  double friction = 0.0;
  struct Limits {
    double low, high;
  };
  std::optional<Limits> limits;
  struct Preload {
    Vec3 force, torque;    // on A
  };
  std::optional<Preload> preload;
  double breaks = HUGE_VAL, breaks_torque = HUGE_VAL;
  bool pulls_only = false;

  bool has_servo() const { return motor || friction > 0.0 || limits; }
  // "hinge 1 2", for messages.
  std::string name() const;
};

// KIND A B words. Throws std::runtime_error.
JointWords read_joint(LineWords &line);
// A joint for each line of a file that is not empty.
std::vector<JointWords> read_joints(const std::string &file, const std::string &text);

}    // namespace mdanim
