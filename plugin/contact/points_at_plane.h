// SPDX-License-Identifier: GPL-2.0-only
// Points of an object near a plane at rest that are particles, for passes over blocks, which compute their contacts themselves
// (passes/plane_blocks.h).

#pragma once

#include "contact/plane_contact.h"

#include <vector>

namespace mdanim {

struct PointAtPlane {
  int particle;
  double area;
  bool was_below;                     // a contact that begins has no potential at the depth at which it begins
  PlaneState<double> state{};         // of its contact; depth 0 where there is none
  double heat = 0.0, damped = 0.0;    // energy that friction and dashpots took, which the account does not hold yet [J]
  double deepest = 0.0;               // largest depth in the passes [m]
};

// The same energy of a point of a field. Point by point, it does not depend on where passes end.
struct LossOfPoint {
  int point;
  double heat, damped;
};

struct PointsAtPlane {
  ContactLaw law;
  double radius;    // of the surface around each point [m]
  int axis;
  double sign, at;    // of the plane, see ContactPlane
  std::vector<PointAtPlane> points;
};

}    // namespace mdanim
