// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/shape.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mdanim {

Pose in_body(const Pose &pose, const RigidBody &body, double size)
{
  constexpr double PARTS = 1LL << 42;
  const auto part = [](double x) { return std::round(x * PARTS) / PARTS; };
  const auto place = [&](double x) { return size * part(x / size); };
  const Vec3 at = transposed_times(body.turn, pose.place - body.centre);
  const Quaternion q = unit(Quaternion{body.q.w, -body.q.x, -body.q.y, -body.q.z} * pose.q);
  return {{place(at.x), place(at.y), place(at.z)}, {part(q.w), part(q.x), part(q.y), part(q.z)}};
}

const SolidShape &SharedShapes::take(SolidShape shape)
{
  const double bound = shape.bound();
  const auto [first, last] = known.equal_range(bound);
  const auto alike = std::find_if(first, last, [&](const auto &other) { return shape.is_same(other.second); });
  return (alike != last ? alike : known.emplace(bound, std::move(shape)))->second;
}

const std::shared_ptr<const Polyhedron> &SolidShape::none()
{
  static const auto empty = std::make_shared<const Polyhedron>();
  return empty;
}

SolidShape SolidShape::of(Polyhedron polyhedron)
{
  SolidShape shape;
  shape.its_kind = POLYHEDRON;
  shape.its_polyhedron = std::make_shared<const Polyhedron>(std::move(polyhedron));
  shape.its_thin = shape.its_polyhedron->thickness();
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

SolidShape SolidShape::torus(double radius, double tube)
{
  SolidShape shape;
  shape.its_kind = TORUS;
  shape.size = {radius, tube, 0.0};
  shape.its_thin = 2.0 * tube;
  return shape;
}

SolidShape SolidShape::of(TriangleMesh mesh, double thin)
{
  SolidShape shape;
  shape.its_kind = MESH;
  shape.its_mesh = std::make_shared<const TriangleMesh>(std::move(mesh));
  shape.its_thin = thin;
  return shape;
}

bool SolidShape::is_same(const SolidShape &other) const
{
  const auto are_same = [](const Vec3 &a, const Vec3 &b) { return a.x == b.x && a.y == b.y && a.z == b.z; };
  const std::vector<Polyhedron::Corner> &one = corners(), &two = other.corners();
  const std::vector<Polyhedron::Face> &faces = its_polyhedron->faces(), &others = other.its_polyhedron->faces();
  return its_kind == other.its_kind && are_same(its_middle, other.its_middle) && are_same(axes[0], other.axes[0]) &&
         are_same(axes[1], other.axes[1]) && are_same(axes[2], other.axes[2]) && are_same(size, other.size) &&
         std::equal(one.begin(), one.end(), two.begin(), two.end(),
                    [&](const Polyhedron::Corner &a, const Polyhedron::Corner &b) { return are_same(a.at, b.at); }) &&
         std::equal(faces.begin(), faces.end(), others.begin(), others.end(),
                    [](const Polyhedron::Face &a, const Polyhedron::Face &b) {
                      return a.corners == b.corners && a.covered == b.covered;
                    });
}

SolidShape SolidShape::placed(const Pose &pose) const
{
  const Matrix3 turn = matrix(pose.q);
  SolidShape shape = *this;
  shape.its_middle = pose.place + turn * its_middle;
  for (Vec3 &axis : shape.axes) axis = turn * axis;
  if (its_kind == POLYHEDRON)
    shape.its_polyhedron =
        std::make_shared<const Polyhedron>(its_polyhedron->moved([&](const Vec3 &at) { return pose.place + turn * at; }));
  const bool is_moved = length(pose.place) > 0.0 || pose.q.w != 1.0;
  if (its_kind == MESH && is_moved)
    shape.its_mesh =
        std::make_shared<const TriangleMesh>(its_mesh->moved([&](const Vec3 &at) { return pose.place + turn * at; }));
  const double middle = length(shape.its_middle);
  double bound = 0.0;
  for (const Polyhedron::Corner &corner : shape.its_polyhedron->corners()) bound = std::max(bound, length(corner.at));
  if (its_kind == BALL) bound = middle + size.x;
  if (its_kind == CYLINDER || its_kind == CONE) bound = middle + std::sqrt(size.x * size.x + size.z * size.z);
  if (its_kind == ELLIPSOID) bound = middle + std::max({size.x, size.y, size.z});
  if (its_kind == TORUS) bound = middle + size.x + size.y;
  if (its_kind == MESH) bound = shape.its_mesh->bound();
  shape.its_bound = bound;
  shape.find_curves();
  return shape;
}

const char *SolidShape::name() const
{
  static const char *const NAMES[] = {"polyhedron", "ball", "cylinder", "cone", "ellipsoid", "torus", "mesh"};
  return NAMES[its_kind];
}

// A polyhedron without sides that were covered when it was made has its edges as curves.
void SolidShape::cover(const std::vector<char> &faces)
{
  Polyhedron covered = *its_polyhedron;
  covered.cover(faces);
  its_polyhedron = std::make_shared<const Polyhedron>(std::move(covered));
  for (std::size_t e = 0; e < its_curves.size(); ++e) its_curves[e].covered = its_polyhedron->edges()[e].covered;
}

// A sharp circle has its axis out of its flat face. The radius about the axis of a cone is that of a ball inside.
void SolidShape::find_curves()
{
  its_curves.clear();
  its_tip.clear();
  for (const Polyhedron::Edge &edge : edges()) {
    if (edge.covered) continue;
    Curve line;
    line.middle = edge.middle;
    line.along = edge.along;
    line.size = edge.half;
    line.across[0] = edge.across[0];
    line.across[1] = edge.across[1];
    its_curves.push_back(line);
  }
  Curve circle;
  circle.is_circle = true;
  circle.any = axes[0];
  circle.size = size.x;
  if (its_kind == TORUS) {
    circle.middle = its_middle;
    circle.along = axes[2];
    circle.thick = circle.reach = size.y;
    its_curves.push_back(circle);
  }
  if (its_kind == ELLIPSOID) {
    Curve egg;
    egg.is_egg = true;
    egg.middle = its_middle;
    egg.along = axes[2];
    egg.any = axes[0];
    egg.half = size;
    egg.reach = std::max({size.x, size.y, size.z});
    its_curves.push_back(egg);
  }
  if (its_kind != CYLINDER && its_kind != CONE) return;
  const double tangent = its_kind == CONE ? 0.5 * size.x / size.z : 0.0, cosine = 1.0 / std::sqrt(1.0 + tangent * tangent);
  Curve axis;
  axis.middle = its_middle;
  axis.along = axes[2];
  axis.size = size.z;
  axis.thick = its_kind == CONE ? 0.5 * size.x * cosine : size.x;
  axis.taper = tangent * cosine;
  axis.reach = size.x;
  its_curves.push_back(axis);
  circle.narrows = axis.taper;
  for (const double end : {-1.0, 1.0}) {
    if (its_kind == CONE && end > 0.0) continue;
    circle.along = end * axes[2];
    circle.middle = its_middle + (end * size.z) * axes[2];
    its_curves.push_back(circle);
  }
  if (its_kind == CYLINDER) return;
  Polyhedron::Corner tip{its_middle + size.z * axes[2], {}, {}};
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      if (x != 0 || y != 0) {
        const Vec3 out = (size.x / std::sqrt(x * x + y * y)) * ((1.0 * x) * axes[0] + (1.0 * y) * axes[1]);
        const Vec3 way = out - (2.0 * size.z) * axes[2];
        tip.ways.push_back((1.0 / length(way)) * way);
      }
  its_tip.push_back(tip);
}

void SolidShape::each_feature(const std::function<void(const Vec3 &, const Vec3 &)> &visit) const
{
  for (const Polyhedron::Corner &corner : its_polyhedron->corners())
    for (const int face : corner.faces) visit(corner.at, its_polyhedron->faces()[face].normal);
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
  if (its_kind == TORUS) each_feature_of_torus(visit);
  if (its_kind == MESH)
    for (const Polyhedron::Corner &corner : its_mesh->corners())
      for (const int side : corner.faces) visit(corner.at, its_mesh->sides()[side].normal);
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

// Around the tube, at eight places of the ring.
void SolidShape::each_feature_of_torus(const std::function<void(const Vec3 &, const Vec3 &)> &visit) const
{
  constexpr double DIAGONAL = 0.70710678118654752440;
  for (const double x : {-1.0, -DIAGONAL, 0.0, DIAGONAL, 1.0})
    for (const double sign : {-1.0, 1.0}) {
      const Vec3 out = x * axes[0] + (sign * std::sqrt(1.0 - x * x)) * axes[1];
      for (const double up : {-1.0, -DIAGONAL, 0.0, DIAGONAL, 1.0}) {
        const Vec3 n = std::sqrt(1.0 - up * up) * out + up * axes[2];
        visit(its_middle + size.x * out + size.y * n, n);
      }
    }
}

// --- closest points ---

namespace {

// In a half plane through the axis: distance from the axis, place along it.
struct InHalfPlane {
  double out, along;
};

// The signed distance from a straight part of an outline with the body to its left, and the direction to the point: straight
// across, or from one of the ends. `is_across` tells which.
struct FromPart {
  double above, distance;
  InHalfPlane n;
  FromPart(const InHalfPlane &a, const InHalfPlane &b, const InHalfPlane &p)
  {
    const double x = b.out - a.out, y = b.along - a.along, size = std::sqrt(x * x + y * y);
    const InHalfPlane across{y / size, -x / size};
    above = (p.out - a.out) * across.out + (p.along - a.along) * across.along;
    const double s = std::min(std::max(((p.out - a.out) * x + (p.along - a.along) * y) / (size * size), 0.0), 1.0);
    const double out = p.out - a.out - s * x, along = p.along - a.along - s * y;
    distance = std::sqrt(out * out + along * along);
    n = distance > 0.0 && s * (1.0 - s) == 0.0 ? InHalfPlane{out / distance, along / distance} : across;
  }
};

}    // namespace

// Outlines of cylinders and cones, from the middle of the base counter-clockwise.
Polyhedron::Foot SolidShape::nearest_of_revolution(const Vec3 &from_middle) const
{
  const double along = dot(from_middle, axes[2]);
  const Vec3 across = from_middle - along * axes[2];
  const double out = length(across);
  const Vec3 radial = out > 0.0 ? (1.0 / out) * across : axes[0];
  const InHalfPlane foot{0.0, -size.z}, rim{size.x, -size.z}, top_rim{size.x, size.z}, top{0.0, size.z}, p{out, along};
  const FromPart parts[3] = {
      {foot, rim, p}, {rim, its_kind == CONE ? top : top_rim, p}, {its_kind == CONE ? rim : top_rim, top, p}};
  const FromPart *inside = parts, *outside = nullptr;
  for (const FromPart &part : parts) {
    if (part.above > inside->above) inside = &part;
    if (part.above > 0.0 && (!outside || part.distance < outside->distance)) outside = &part;
  }
  const FromPart &found = outside ? *outside : *inside;
  return {found.n.out * radial + found.n.along * axes[2], outside ? found.distance : found.above};
}

Polyhedron::Foot SolidShape::nearest_of_ellipsoid(const Vec3 &from_middle) const
{
  const EllipsoidFoot at({dot(from_middle, axes[0]), dot(from_middle, axes[1]), dot(from_middle, axes[2])},
                         {size.x, size.y, size.z});
  Vec3 foot, n;
  for (int k = 0; k < 3; ++k) {
    foot += at.at[k] * axes[k];
    n += at.normal[k] * axes[k];
  }
  const double steepness = length(n);
  n = steepness > 0.0 ? (1.0 / steepness) * n : axes[0];
  return {n, dot(from_middle - foot, n)};
}

Polyhedron::Foot SolidShape::nearest(const Vec3 &x) const
{
  const Vec3 from_middle = x - its_middle;
  if (its_kind == POLYHEDRON) return its_polyhedron->nearest(x);
  if (its_kind == CYLINDER || its_kind == CONE) return nearest_of_revolution(from_middle);
  if (its_kind == ELLIPSOID) return nearest_of_ellipsoid(from_middle);
  if (its_kind == TORUS) {
    const Vec3 from = x - closest(its_curves[0], x).at;
    const double far = length(from);
    return {far > 0.0 ? (1.0 / far) * from : axes[2], far - size.y};
  }
  const double distance = length(from_middle);
  return {distance > 0.0 ? (1.0 / distance) * from_middle : axes[0], distance - size.x};
}

}    // namespace mdanim
