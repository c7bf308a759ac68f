// SPDX-License-Identifier: GPL-2.0-only
// Particles at planes (contact/points_at_plane.h) as passes know them, in rows of one number for each lane of a block. Plain
// data; simd/of_set.h says why.

#pragma once

#include "contact/law.h"

namespace mdanim {

// Numbers of a lane: of its plane, see ContactPlane, and the area of its point. A lane without a point has an area of 0 and a
// plane that nothing reaches.
enum PlaneCoefficient { SIGN, AT, AREA, PLANE_COEFFICIENTS };

// Numbers that change, see PointAtPlane. Those from DAMPING on are kept where there is friction.
enum PlaneNumber {
  OFFSET,    // infinite for a point that was below its plane without a contact
  DEPTH,
  DEEPEST,
  ANCHOR,
  SMOOTH_NUMBERS = ANCHOR + 3,
  DAMPING = SMOOTH_NUMBERS,
  STICK,
  STICK_ENERGY,
  PULL,
  DRAG = PULL + 3,
  HEAT = DRAG + 3,
  DAMPED,
  ROUGH_NUMBERS
};

struct PlaneLaw {
  ContactLaw law;
  double radius;    // of the surface around each point [m]
};

// Particles of a block, each at one plane across the same axis. Rows of a block are in the order in which planes act.
struct PlaneRow {
  int axis;
  unsigned law;             // of PlaneRows::law
  unsigned coefficients;    // row of PlaneRows::coefficient
  int kept;                 // its first number in PlaneRows::kept, over the number of lanes
  int provider;             // its number among those that give forces
  bool is_last;             // of the block
};

struct PlaneRows {
  const PlaneRow *row;
  const PlaneLaw *law;
  const double *coefficient;    // rows of PLANE_COEFFICIENTS
  double *kept;                 // SMOOTH_NUMBERS or ROUGH_NUMBERS of each row
  double dt;
};

}    // namespace mdanim
