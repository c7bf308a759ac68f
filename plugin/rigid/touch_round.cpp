// SPDX-License-Identifier: GPL-2.0-only
// Contacts of round shapes, whose points of contact move over them; and of all shapes with planes.

#include "rigid/egg_point.h"
#include "rigid/pair.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

static Vec3 middle_of(const Solid &solid) { return solid.place(solid.shape.middle()); }

void touch_balls(const TouchStep &step, SolidPair &pair, Solid &a, Solid &b, const TouchLaw &law)
{
  const Vec3 place = middle_of(a), between = place - middle_of(b);
  const double distance = length(between), both = a.shape.radius() + b.shape.radius();
  const Vec3 n = distance > 0.0 ? (1.0 / distance) * between : Vec3{0.0, 0.0, 1.0};
  // Between both surfaces, nearer to that of the smaller one.
  const Vec3 x = place - (a.shape.radius() * distance / both) * n;
  step.press_moving(pair.touches, Touch::MOVING, 0, law, a, &b, x, n, both - distance);
}

void touch_ball_and_other(const TouchStep &step, SolidPair &pair, Solid &ball, Solid &host, const TouchLaw &law)
{
  const Vec3 place = middle_of(ball), in_host = host.in_body(place - host.centre);
  const double radius = ball.shape.radius();
  const bool is_polyhedron = host.shape.kind() == SolidShape::POLYHEDRON;
  if (pair.touches.empty() && is_polyhedron && host.shape.polyhedron().outside(in_host) >= radius) return;
  const Polyhedron::Foot nearest = host.shape.nearest(in_host);
  const Vec3 n = host.in_space(nearest.normal);
  step.press_moving(pair.touches, Touch::MOVING, 0, law, ball, &host, place - radius * n, n, radius - nearest.distance);
}

// --- ellipsoids ---

// The ball that fits the ellipsoid where its normal is n touches the host with a normal nearer to the one sought: both are
// opposite in the end. The contact remembers its normal as the first guess.
void touch_ellipsoid_and_other(const TouchStep &step, SolidPair &pair, Solid &egg, Solid &host, const TouchLaw &law)
{
  constexpr int MOST_STEPS = 100;
  constexpr double ENOUGH = 1e-26;    // square of the way of the normal
  const Vec3 middle = host.in_body(middle_of(egg) - host.centre), &half = egg.shape.half_axes();
  const Polyhedron::Foot from_middle = host.shape.nearest(middle);
  if (pair.touches.empty() && from_middle.distance >= std::max({half.x, half.y, half.z})) return;
  Vec3 n = pair.touches.empty() ? from_middle.normal : pair.touches[0].place;
  const auto in_egg = [&](const Vec3 &a) { return egg.in_body(host.in_space(a)); };
  const auto in_host = [&](const Vec3 &a) { return host.in_body(egg.in_space(a)); };
  Vec3 x;
  double depth = 0.0;
  for (int k = 0; k < MOST_STEPS; ++k) {
    const EggPoint point(egg, in_egg(-1.0 * n));
    x = middle + in_host(point.at);
    const Polyhedron::Foot foot = host.shape.nearest(x + point.radius * n);
    depth = point.radius - foot.distance;
    const Vec3 way = foot.normal - n;
    n = foot.normal;
    if (dot(way, way) < ENOUGH) break;
  }
  step.press_moving(pair.touches, Touch::MOVING, 0, law, egg, &host, host.place(x), host.in_space(n), depth);
  if (!pair.touches.empty()) pair.touches[0].place = n;
}

// --- planes ---

namespace {

// Four points of a circle about `axis`: the lowest, those a quarter from it, the highest.
struct Rim {
  Vec3 out[4];
  Rim(const Vec3 &axis, const Vec3 &any, const Vec3 &n)
  {
    constexpr double LEVEL = 1e-9;    // the sine of the lean below which no point is the lowest
    const Vec3 down = dot(n, axis) * axis - n;
    const double size = length(down);
    out[0] = size > LEVEL ? (1.0 / size) * down : any;
    out[1] = cross(axis, out[0]);
    out[2] = -1.0 * out[1];
    out[3] = -1.0 * out[0];
  }
};

class OnPlane {
 public:
  OnPlane(const TouchStep &step, std::vector<Touch> &touches, Solid &one, const SolidPlane &plane, const TouchLaw &law)
      : step(step), touches(touches), one(one), plane(plane), law(law)
  {
  }

  void moving(int number, const Vec3 &x) const
  { step.press_moving(touches, Touch::MOVING, number, law, one, nullptr, x, plane.n, depth(x)); }
  void corner(int number, const Vec3 &x) const
  {
    const double d = depth(x);
    if (Touch *const touch = step.meet(touches, Touch::CORNER, number, law, one, nullptr, x, plane.n, d, x))
      step.press(*touch, law, one, nullptr, x, d, 1.0, {}, plane.n);
  }
  void rim(int first, const Vec3 &middle, double radius, double tube = 0.0) const
  {
    const Vec3 axis = one.in_space(one.shape.axis(2));
    const Rim points(axis, one.in_space(one.shape.axis(0)), plane.n);
    for (int k = 0; k < 4; ++k) moving(first + k, middle + radius * points.out[k] - tube * plane.n);
  }

 private:
  double depth(const Vec3 &x) const { return plane.at - dot(plane.n, x); }
  const TouchStep &step;
  std::vector<Touch> &touches;
  Solid &one;
  const SolidPlane &plane;
  const TouchLaw &law;
};

Vec3 lowest_of_ellipsoid(const Solid &one, const Vec3 &n)
{
  const Vec3 own = one.in_body(n), &half = one.shape.half_axes();
  const Vec3 an{half.x * dot(own, one.shape.axis(0)), half.y * dot(own, one.shape.axis(1)), half.z * dot(own, one.shape.axis(2))};
  const double over = 1.0 / length(an);
  return (half.x * an.x * over) * one.shape.axis(0) + (half.y * an.y * over) * one.shape.axis(1) +
         (half.z * an.z * over) * one.shape.axis(2);
}

}    // namespace

void touch_plane(const TouchStep &step, std::vector<Touch> &touches, Solid &one, const SolidPlane &plane, const TouchLaw &law)
{
  const OnPlane on(step, touches, one, plane, law);
  const SolidShape &shape = one.shape;
  const Vec3 middle = middle_of(one), along = shape.half_height() * one.in_space(shape.axis(2));
  switch (shape.kind()) {
    case SolidShape::POLYHEDRON:
    case SolidShape::MESH:
      for (std::size_t q = 0; q < shape.corners().size(); ++q)
        if (!shape.corners()[q].covered) on.corner(static_cast<int>(q), one.place(shape.corners()[q].at));
      break;
    case SolidShape::BALL:
      on.moving(0, middle - shape.radius() * plane.n);
      break;
    case SolidShape::CYLINDER:
      on.rim(0, middle + along, shape.radius());
      on.rim(4, middle - along, shape.radius());
      break;
    case SolidShape::CONE:
      on.corner(0, middle + along);
      on.rim(0, middle - along, shape.radius());
      break;
    case SolidShape::ELLIPSOID:
      on.moving(0, middle - one.in_space(lowest_of_ellipsoid(one, plane.n)));
      break;
    case SolidShape::TORUS:
      on.rim(0, middle, shape.radius(), shape.tube());
      break;
  }
}

}    // namespace mdanim
