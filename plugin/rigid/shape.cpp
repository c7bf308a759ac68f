// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/shape.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mdanim {

static double length(const Vec3 &a) { return std::sqrt(dot(a, a)); }

SolidShape SolidShape::of(Polyhedron polyhedron)
{
  SolidShape shape;
  shape.its_kind = POLYHEDRON;
  shape.its_polyhedron = std::move(polyhedron);
  shape.its_thin = shape.its_polyhedron.thickness();
  return shape;
}

SolidShape SolidShape::ball(double radius)
{
  SolidShape shape;
  shape.its_kind = BALL;
  shape.size = {radius, radius, radius};
  shape.its_thin = 2.0 * radius;
  return shape;
}

SolidShape SolidShape::cylinder(double radius, double height)
{
  SolidShape shape;
  shape.its_kind = CYLINDER;
  shape.size = {radius, radius, 0.5 * height};
  shape.its_thin = std::min(2.0 * radius, height);
  return shape;
}

SolidShape SolidShape::cone(double radius, double height)
{
  SolidShape shape = cylinder(radius, height);
  shape.its_kind = CONE;
  return shape;
}

SolidShape SolidShape::ellipsoid(const Vec3 &half_axes)
{
  SolidShape shape;
  shape.its_kind = ELLIPSOID;
  shape.size = half_axes;
  shape.its_thin = 2.0 * std::min({half_axes.x, half_axes.y, half_axes.z});
  return shape;
}

SolidShape SolidShape::placed(const Pose &pose) const
{
  const Matrix3 turn = matrix(pose.q);
  SolidShape shape = *this;
  shape.its_middle = pose.place + turn * its_middle;
  for (Vec3 &axis : shape.axes) axis = turn * axis;
  if (its_kind == POLYHEDRON) shape.its_polyhedron = its_polyhedron.moved([&](const Vec3 &at) { return pose.place + turn * at; });
  const double middle = length(shape.its_middle);
  double bound = 0.0;
  for (const Polyhedron::Corner &corner : shape.its_polyhedron.corners()) bound = std::max(bound, length(corner.at));
  if (its_kind == BALL) bound = middle + size.x;
  if (its_kind == CYLINDER || its_kind == CONE) bound = middle + std::sqrt(size.x * size.x + size.z * size.z);
  if (its_kind == ELLIPSOID) bound = middle + std::max({size.x, size.y, size.z});
  shape.its_bound = bound;
  return shape;
}

const char *SolidShape::name() const
{
  static const char *const NAMES[] = {"polyhedron", "ball", "cylinder", "cone", "ellipsoid"};
  return NAMES[its_kind];
}

void SolidShape::each_feature(const std::function<void(const Vec3 &, const Vec3 &)> &visit) const
{
  for (const Polyhedron::Corner &corner : its_polyhedron.corners())
    for (const int face : corner.faces) visit(corner.at, its_polyhedron.faces()[face].normal);
  if (its_kind == BALL || its_kind == ELLIPSOID)
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          if (x == 0 && y == 0 && z == 0) continue;
          const Vec3 n = (1.0 / std::sqrt(x * x + y * y + z * z)) * Vec3{1.0 * x, 1.0 * y, 1.0 * z};
          const Vec3 an{size.x * n.x, size.y * n.y, size.z * n.z};
          const Vec3 at = (1.0 / length(an)) * Vec3{size.x * an.x, size.y * an.y, size.z * an.z};
          const auto turned = [this](const Vec3 &a) { return a.x * axes[0] + a.y * axes[1] + a.z * axes[2]; };
          visit(its_middle + turned(at), turned(n));
        }
  if (its_kind == CYLINDER || its_kind == CONE)
    for (const double end : {-1.0, 1.0}) {
      if (its_kind == CONE && end > 0.0) {
        visit(its_middle + size.z * axes[2], axes[2]);
        continue;
      }
      for (int k = 0; k < 4; ++k) {
        const Vec3 out = (k < 2 ? 1.0 : -1.0) * axes[k % 2];
        const Vec3 at = its_middle + size.x * out + (end * size.z) * axes[2];
        visit(at, out);
        visit(at, end * axes[2]);
      }
    }
}

bool know_each_other(SolidShape::ShapeKind a, SolidShape::ShapeKind b)
{
  const auto is_known = [](SolidShape::ShapeKind kind) { return kind == SolidShape::BALL || kind == SolidShape::POLYHEDRON; };
  return is_known(a) && is_known(b);
}

}    // namespace mdanim
