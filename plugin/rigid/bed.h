// SPDX-License-Identifier: GPL-2.0-only
// The force that a flat surface gives to pieces that are glued together, spread over all that lie on it (docs/physics-pieces.md).
//
// Contact acts at the corners of a whole. What is between these lies on the surface too, and bears its part:
//   p = w max(0, a + b x + c y),
// the pressure under a rigid body on springs that do not pull (Winkler), with a, b, c such that force and torque on the whole
// stay. Friction stays where it is.

#pragma once

#include "numbers/vec3.h"
#include "rigid/glue_springs.h"

#include <vector>

namespace mdanim {

struct Bed {
  // A corner of a piece that lies on the surface, and its part of the area.
  struct BedSpot {
    int piece, corner;
    Vec3 centre, at;
    double area;
  };
  // The force of contact on a piece, and where it acts.
  struct BedPress {
    int piece;
    Vec3 centre, at;
    double force;
  };

  Vec3 n;             // pushes the pieces
  double at = 0.0;    // n . X of the surface
  std::vector<BedPress> pressed;
  std::vector<BedSpot> spots;

  // Force and torque on a piece about its centre, as what presses it.
  void press(int piece, const Vec3 &centre, const Vec3 &force, const Vec3 &torque);
  // Adds what each piece bears more than contact gives it, by the numbers of pieces; forces and torques of all of them are 0
  // together. A corner that is in the list twice lies on both of two sides that meet.
  void spread(PieceMotions &more);

 private:
  Vec3 flat(const Vec3 &x) const { return x - (dot(n, x) - at) * n; }
};

}    // namespace mdanim
