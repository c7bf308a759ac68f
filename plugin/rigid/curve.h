// SPDX-License-Identifier: GPL-2.0-only
// Curves of bodies that touch: straight lines and circles, sharp as edges and rims are, or with a radius about them. A cylinder
// is a line with a radius, a cone one whose radius changes along it, a torus a circle with one.

#pragma once

#include "numbers/vec3.h"

#include <cmath>
#include <vector>

namespace mdanim {

struct Curve {
  bool is_circle = false, is_egg = false;
  bool covered = false;    // touches nothing now
  Vec3 middle, along;      // along a line; the axis of a circle, out of its flat face. Of length 1
  Vec3 any;                // of a circle: some direction from its middle to it, of length 1
  double size = 0.0;       // half of the length of a surface about a line; radius of a circle
  double thick = 0.0;      // radius about the curve, at the middle of a line
  double taper = 0.0;      // by which it falls along a line
  double reach = 0.0;      // how far the surface is from the curve
  Vec3 across[2];          // of a sharp line: within its faces, away from it; of length 1
  double narrows = 0.0;    // of a rim: sine of the lean of the curved side towards the axis
  Vec3 half;               // of an ellipsoid: its half axes, along `any`, across both, and along `along`

  bool is_sharp() const { return thick == 0.0 && !is_egg; }
  // Within the curved side of a rim, away from its point in the direction e.
  Vec3 into_side(const Vec3 &e) const { return -std::sqrt(1.0 - narrows * narrows) * along - narrows * e; }
  double radius_at(double s) const { return thick - taper * s; }
  // Where the surface is, along the line, that the ball about the place s touches.
  double on_surface(double s) const { return s + taper * radius_at(s); }

  // The same curve after p -> move(p) of its points and a -> turn(a) of its directions.
  template <class Move, class Turn> Curve moved(const Move &move, const Turn &turn) const
  {
    Curve found = *this;
    found.middle = move(middle);
    for (Vec3 *const direction : {&found.along, &found.any, &found.across[0], &found.across[1]}) *direction = turn(*direction);
    return found;
  }
};

// A point of a curve, the middle of a ball of this radius that touches the surface from inside.
struct CurvePoint {
  Vec3 at, tangent;
  double radius = 0.0, place = 0.0;    // `place`: along a line, where the surface is
  Vec3 across[2];                      // of sharp curves: within both faces
  CurvePoint() = default;
  // The point of a line at s, or that of a circle in the direction e from its middle.
  CurvePoint(const Curve &line, double s);
  CurvePoint(const Curve &circle, const Vec3 &e);
};

// Where two curves are closest.
struct CurveMeeting {
  CurvePoint a, b;
};

// Where the surface of an ellipsoid is closest to x, and a vector along its normal there, both about its middle and along its
// axes.
struct EllipsoidFoot {
  double at[3], normal[3];
  EllipsoidFoot(const double (&x)[3], const double (&half)[3]);
};

// The point of a curve with its radius that is closest to p.
CurvePoint closest(const Curve &curve, const Vec3 &p);
// All places where two curves are closest to each other. Lines that are nearly parallel have none.
std::vector<CurveMeeting> meetings(const Curve &a, const Curve &b);
// The one near a place that is known: of circles. Of lines, that one.
CurveMeeting meeting_near(const Curve &a, const Curve &b, const CurveMeeting &known);
// No more than the distance between both curves less their radii.
double least_gap(const Curve &a, const Curve &b);

}    // namespace mdanim
