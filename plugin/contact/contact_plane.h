// SPDX-License-Identifier: GPL-2.0-only
// A plane across an axis.

#pragma once

#include "geometry/zone.h"
#include "numbers/vec3.h"

namespace mdanim {

struct ContactPlane {
  int axis;
  double sign;    // 1: objects belong above, -1: below
  double at;      // at the start [m]
  bool moves = false;
  // Displacement of a plane that moves from the start, that since it was moved last, as lists are made within a step, and the
  // way of the step [m].
  Vec3 shift{}, way{}, of_step{};

  void move_to(const Vec3 &now, const Vec3 &in_this_step)
  {
    way = now - shift;
    shift = now;
    of_step = in_this_step;
  }
  // The coordinate of a vector across it.
  double across(const Vec3 &a) const { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }
  double place() const { return at + across(shift); }
  // How far lists reach beyond the skin [m]: until they are made anew it goes no farther.
  double ahead(double skin) const { return moves ? 0.5 * skin : 0.0; }
  double depth(const Vec3 &x) const { return sign * (at - across(x - shift)); }
  // The zone up to `gap` above the plane.
  Zone within(double gap) const
  {
    Zone zone;
    for (double &side : zone.box.bound) side = -Box::FAR;
    zone.across = -1.0 * normal();
    zone.from = -sign * place() - gap;
    return zone;
  }
  Vec3 normal() const { return {axis == 0 ? sign : 0.0, axis == 1 ? sign : 0.0, axis == 2 ? sign : 0.0}; }
};

}    // namespace mdanim
