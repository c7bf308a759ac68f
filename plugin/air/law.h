// SPDX-License-Identifier: GPL-2.0-only
// Pressure of air that streams past a surface, without a wake.

#pragma once

#include "numbers/vec3.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

// The sides of a surface that air pushes at.
enum class AirSides { OUTER, BOTH };

// With the velocity of the air w, that of the surface v, the outward normal n of length 1, density rho and the coefficient C:
//   u = n.(w - v),   F = 1/2 rho C A |u| u n        outer side of a solid: where u < 0 alone
// A cylinder of diameter d and length l along t, as a link of a rope:
//   u = (w - v) - t (t.(w - v)),   F = 1/2 rho C d l |u| u
// A ball of diameter d, the integral of the outer side of a sphere:
//   u = w - v,   F = 1/2 rho (C/2) (pi d^2/4) |u| u
// A force slows the motion relative to the air by the part 1/2 rho C |u| dt A/m in a step. Explicit steps are stable up to parts
// of order 1: where it is above MOST, the force is lowered to that part.
struct AirLaw {
  static constexpr double MOST = 0.25;

  Vec3 wind;
  double half;    // rho C/2
  double dt;

  // Lowers |u|: F = rho C/2 A |u|' u. `load` is the area over the mass that moves with it.
  double effective(double speed, double load) const
  {
    const double part = half * speed * dt * load;
    return part > MOST ? speed * (MOST / part) : speed;
  }

  // Force on a part of a surface with this velocity. `area` has the direction of the outward normal, and the length of the area,
  // which is `size`.
  Vec3 on_surface(const Vec3 &area, double size, const Vec3 &velocity, AirSides sides, double load) const
  {
    const double flow = dot(area, wind - velocity);    // A u
    if (size == 0.0 || (sides == AirSides::OUTER && flow >= 0.0)) return {};
    const double u = flow / size;
    return (half * effective(std::fabs(u), load) * u) * area;
  }

  // Force on a cylinder from one place to another by `way`.
  Vec3 on_cylinder(const Vec3 &way, double diameter, const Vec3 &velocity, double load) const
  {
    const double size = length(way);
    if (size == 0.0) return {};
    const Vec3 t = (1.0 / size) * way, past = wind - velocity, u = past - dot(t, past) * t;
    return (half * diameter * size * effective(length(u), load)) * u;
  }

  static double face_of_ball(double diameter) { return 0.78539816339744831 * diameter * diameter; }
  Vec3 on_ball(double diameter, const Vec3 &velocity, double load) const
  {
    const Vec3 u = wind - velocity;
    return (0.5 * half * face_of_ball(diameter) * effective(length(u), load)) * u;
  }
};

}    // namespace mdanim
