// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/shapes_file.h"

#include "records/line_words.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>
#include <vector>

namespace mdanim {

namespace {

// Makes a polyhedron; what is wrong with it is told with the line.
template <class Make> SolidShape made(const LineWords &words, const Make &make)
{
  try {
    return SolidShape::of(make());
  } catch (const std::runtime_error &problem) {
    words.fail(problem.what());
  }
}

SolidShape read_polyhedron(LineWords &words)
{
  std::vector<Vec3> corners(words.many("the number of corners", 3));
  for (Vec3 &corner : corners) corner = words.place("a corner");
  std::vector<std::vector<int>> faces(words.many("the number of faces", 4));
  for (std::vector<int> &face : faces) {
    face.resize(words.many("the number of corners of a face", 1));
    for (int &corner : face) corner = words.number<int>("a corner of a face");
    if (face.size() < 3) words.fail("a face has fewer than three corners");
  }
  return made(words, [&] { return Polyhedron(corners, faces); });
}

SolidShape read_mesh(LineWords &words)
{
  const double thin = words.extent("the thickness");
  std::vector<Vec3> places(words.many("the number of corners", 3));
  for (Vec3 &at : places) at = words.place("a corner");
  std::vector<TriangleMesh::Corners> triangles(words.many("the number of triangles", 3));
  for (TriangleMesh::Corners &triangle : triangles)
    for (int &corner : triangle) corner = words.number<int>("a corner of a triangle");
  try {
    return SolidShape::of(TriangleMesh(std::move(places), triangles), thin);
  } catch (const std::runtime_error &problem) {
    words.fail(problem.what());
  }
}

// The sides of a box that other bodies cover.
std::vector<int> read_covered(LineWords &words)
{
  static const std::string SIDES[] = {"-x", "+x", "-y", "+y", "-z", "+z"};    // as Polyhedron::box has them
  std::vector<int> sides;
  if (words.is_at_end()) return sides;
  if (const std::string word = words.word("covered"); word != "covered")
    words.fail("there is more than belongs to it, from " + word + " on");
  do {
    const std::string side = words.word("a side that is covered");
    const auto found = std::find(std::begin(SIDES), std::end(SIDES), side);
    if (found == std::end(SIDES)) words.fail("a side is -x, +x, -y, +y, -z or +z, got " + side);
    sides.push_back(static_cast<int>(found - std::begin(SIDES)));
  } while (!words.is_at_end());
  return sides;
}

SolidShape read_shape(LineWords &words)
{
  const std::string kind = words.word("the shape");
  if (kind == "box") {
    const double x = words.extent("a side"), y = words.extent("a side"), z = words.extent("a side");
    const std::vector<int> covered = read_covered(words);
    return made(words, [&] {
      Polyhedron box = Polyhedron::box({0.5 * x, 0.5 * y, 0.5 * z});
      for (const int side : covered) box.cover(side);
      return box;
    });
  }
  if (kind == "ball") return SolidShape::ball(words.extent("the radius"));
  if (kind == "cylinder" || kind == "cone") {
    const double radius = words.extent("the radius"), height = words.extent("the height");
    return kind == "cone" ? SolidShape::cone(radius, height) : SolidShape::cylinder(radius, height);
  }
  if (kind == "ellipsoid") {
    const double x = words.extent("a half axis"), y = words.extent("a half axis"), z = words.extent("a half axis");
    return SolidShape::ellipsoid({x, y, z});
  }
  if (kind == "torus") {
    const double radius = words.extent("the radius"), tube = words.extent("the radius of the tube");
    if (!(tube < radius)) words.fail("the tube of a torus must be thinner than its ring");
    return SolidShape::torus(radius, tube);
  }
  if (kind == "polyhedron") return read_polyhedron(words);
  if (kind == "mesh") return read_mesh(words);
  words.fail("a shape is box, ball, cylinder, cone, ellipsoid, torus, polyhedron or mesh, got " + kind);
}

}    // namespace

std::map<int, GivenShape> read_shapes(const std::string &name, const std::string &text)
{
  return by_molecule(name, text, [](LineWords &words) {
    GivenShape one;
    one.material.friction = words.at_least_zero("friction");
    one.material.damping = words.from_zero_to("damping", Material::MOST_DAMPING);
    std::string held = words.word("free, held or driven");
    one.material.gives_way = held == "usual";
    if (one.material.gives_way) held = words.word("free, held or driven");
    if (held == "rolling") {
      one.material.rolling = words.at_least_zero("the arm of rolling");
      held = words.word("free, held or driven");
    }
    if (held != "free" && held != "held" && held != "driven") words.fail("a body is free, held or driven, got " + held);
    one.held = held != "free";
    one.driven = held == "driven";
    one.pose.place = words.vector("the place");
    Quaternion &q = one.pose.q;
    q.w = words.number<double>("the rotation");
    const Vec3 axis = words.vector("the rotation");
    q.x = axis.x, q.y = axis.y, q.z = axis.z;
    if (std::fabs((q.w * q.w + q.x * q.x) + (q.y * q.y + q.z * q.z) - 1.0) > 1e-6)
      words.fail("the rotation is not a unit quaternion");
    q = unit(q);
    one.shape = read_shape(words);
    words.expect_end();
    return one;
  });
}

}    // namespace mdanim
