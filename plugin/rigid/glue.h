// SPDX-License-Identifier: GPL-2.0-only
// Glue between pieces of a rigid object: faces, and the stress in them (docs/physics-pieces.md).
//
// A face bears the force F and the torque M about its middle. With its normal n, from piece a to piece b, and axes e1, e2 across,
//   pull  = F.n/A + sqrt((M.e1/W1)^2 + (M.e2/W2)^2)       shear = |F - (F.n) n|/A + |M.n|/Wn
// as in the section of a beam: area A, section moduli W. It breaks where one of both is above its strength.
//
// A weld is a face that never breaks; its middle alone counts.

#pragma once

#include "numbers/vec3.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace mdanim {

struct GlueFace {
  int a = 0, b = 0;                // molecule IDs
  int side_a = -1, side_b = -1;    // numbers of the faces of their shapes; -1 where these are not known
  double strength = HUGE_VAL;
  double area = 1.0;
  Vec3 second;         // second moments of area about e1, e2, and their sum about n
  Vec3 section;        // W1, W2, Wn
  Vec3 at, axis[3];    // its middle, and n, e1, e2, in space when bodies are made

  bool is_weld() const { return !std::isfinite(strength); }
};

struct FaceLoad {
  double pull = 0.0, shear = 0.0;

  // By the force and the torque on piece a, along n, e1, e2.
  static FaceLoad of(const GlueFace &face, const Vec3 &force, const Vec3 &torque)
  {
    const double first = torque.y / face.section.x, second = torque.z / face.section.y;
    return {force.x / face.area + std::sqrt(first * first + second * second),
            std::sqrt(force.y * force.y + force.z * force.z) / face.area + std::fabs(torque.x) / face.section.z};
  }
  // Over what the face bears.
  double share(const GlueFace &face) const { return std::max(pull, shear) / face.strength; }
};

// The file of glue: a line for each face or weld. Throws std::runtime_error.
std::vector<GlueFace> read_glue(const std::string &name, const std::string &text);

}    // namespace mdanim
