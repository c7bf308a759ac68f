// SPDX-License-Identifier: GPL-2.0-only
// Bodies on a surface of triangles: balls, and corners in its sides.

#include "rigid/egg_point.h"
#include "rigid/mesh_host.h"
#include "rigid/pair.h"
#include "rigid/round_host.h"
#include "rigid/touch_corners.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

static std::vector<int> sides_of(const TriangleMesh &mesh, const std::vector<int> &triangles)
{
  std::vector<int> sides;
  for (const int triangle : triangles) sides.push_back(mesh.triangles()[triangle].side);
  std::sort(sides.begin(), sides.end());
  sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
  return sides;
}

bool is_far_from_mesh(SolidPair &pair, const Solid &a, const Solid &b)
{
  constexpr double SURELY = 0.99, WIDER = 4.0, MOST = 1e3;    // over the margin
  const bool is_first = a.shape.kind() == SolidShape::MESH;
  const Solid &mesh = is_first ? a : b, &other = is_first ? b : a;
  const double margin = margin_of(a, b);
  double free = 0.0;
  for (double more = margin; more < MOST * margin; more *= WIDER) {
    if (!mesh.shape.mesh().triangles_near(box_around(mesh, other, more)).empty()) break;
    free = more;
  }
  pair.asleep = SURELY * free;
  return free > 0.0;
}

void look_up_sides(SolidPair &pair, const Solid &a, const Solid &b, double margin)
{
  pair.known_for = margin;
  for (const bool of_other : {false, true}) {
    const Solid &host = of_other ? a : b, &other = of_other ? b : a;
    pair.sides[of_other].clear();
    if (host.shape.kind() != SolidShape::MESH) continue;
    const TriangleMesh &mesh = host.shape.mesh();
    pair.sides[of_other] = sides_of(mesh, mesh.triangles_near(box_around(host, other, ramp_of(host) + margin)));
  }
}

// --- corners ---

// Corners with the sides that they may be below before both bodies have moved by the margin.
static void look_up_below(std::vector<std::pair<int, int>> &below, const std::vector<Touch> &touches, Touch::TouchKind kind,
                          const Solid &a, const Solid &b, double margin)
{
  const TriangleMesh &mesh = b.shape.mesh();
  const Vec3 between = b.in_body(a.centre - b.centre);
  const double reach = ramp_of(b) + margin;
  below.clear();
  each_corner_near(a, b, reach, touches, kind, [&](int q) {
    const Vec3 x = between + b.in_body(a.in_space(a.shape.corners()[q].at));
    Box box;
    box.include(&x.x);
    std::vector<int> near = mesh.triangles_near(box.grown(reach));
    near.erase(std::remove_if(near.begin(), near.end(), [&](int t) { return mesh.distance(t, x) > reach; }), near.end());
    for (const int side : sides_of(mesh, near)) below.emplace_back(q, side);
    if (near.empty() && find_touch(touches, kind, q) != touches.end()) below.emplace_back(q, -1);
  });
}

// Corners of `a` in a mesh, which may be below several of its sides: contacts of a corner differ in these.
static void touch_corners_in_mesh(const TouchStep &step, SolidPair &pair, bool of_other, Solid &a, Solid &b, const TouchLaw &law,
                                  double margin, bool stale)
{
  constexpr double ONE_PART = 0.866;    // cosine between sides that a corner touches once
  const Touch::TouchKind kind = of_other ? Touch::CORNER_OF_OTHER : Touch::CORNER;
  const MeshHost host(b.shape.mesh(), ramp_of(b), pair.sides[of_other]);
  std::vector<Touch> &touches = pair.touches;
  if (stale) look_up_below(pair.below[of_other], touches, kind, a, b, margin);
  const Vec3 between = b.in_body(a.centre - b.centre);
  const auto in_owner = [&](const Vec3 &n) { return a.in_body(b.in_space(n)); };
  int last = -1;
  Vec3 x;
  for (const auto &[q, side] : pair.below[of_other]) {
    const auto is_its = [&, corner = q](const Touch &touch) { return touch.kind == kind && touch.first == corner; };
    if (q != last) {
      last = q;
      x = between + b.in_body(a.in_space(a.shape.corners()[q].at));
      for (Touch &touch : touches)
        if (is_its(touch)) {
          touch.side = host.shallowest(touch.side, x);
          press_corner(step, touch, x, a, b, host, law);
        }
    }
    if (side < 0 || !host.is_below(side, a.shape.corners()[q], in_owner, x, DEEPEST_BIRTH * b.shape.thin())) continue;
    const bool is_known = std::any_of(touches.begin(), touches.end(), [&, number = side](const Touch &touch) {
      return is_its(touch) && dot(host.normal(touch.side, x), host.normal(number, x)) > ONE_PART;
    });
    Vec3 unused;
    if (is_known || host.part(side, x, unused) <= 0.0) continue;
    touches.push_back(born_below(step, kind, q, side, x, host.depth(side, x), a, b, host, law));
    press_corner(step, touches.back(), x, a, b, host, law);
  }
}

void touch_corners_in(const TouchStep &step, SolidPair &pair, bool of_other, Solid &a, Solid &b, const TouchLaw &law,
                      double margin, bool stale)
{
  const auto with = [&](const auto &host) { touch_corners(step, pair, of_other, a, b, host, law, ramp_of(b), margin, stale); };
  if (b.shape.kind() == SolidShape::MESH)
    touch_corners_in_mesh(step, pair, of_other, a, b, law, margin, stale);
  else if (b.shape.kind() == SolidShape::POLYHEDRON)
    with(PolyhedronHost(b.shape.polyhedron(), ramp_of(b)));
  else
    with(RoundHost(b.shape, ramp_of(b)));
}

// --- balls ---

namespace {

constexpr double ONE_PATCH = 0.916, TWO_PATCHES = 0.05;    // cosine between normals about which two contacts become one
constexpr double SAME_PLACE = 0.5;                         // over the radius: how far a contact may move over a mesh in a step
constexpr double SAME_DISTANCE = 1e-10;                    // the same: points of two triangles that are one

// A point of a triangle that is closest to the middle of a ball.
struct BallFoot {
  int triangle = -1;
  TrianglePoint point;
  Vec3 n;
  double depth = 0.0, part = 1.0;
};

// Triangles that may touch before both bodies have moved by the margin, and those next to them that are nearer.
void look_up_triangles(SolidPair &pair, const TriangleMesh &mesh, const Vec3 &x, double radius, double margin)
{
  pair.known_for = margin;
  const double reach = radius + 2.0 * margin;
  Box box;
  box.include(&x.x);
  pair.triangles.clear();
  for (const int triangle : mesh.triangles_near(box.grown(reach)))
    if (mesh.distance(triangle, x) < reach) pair.triangles.push_back(triangle);
}

class BallOnMesh {
 public:
  BallOnMesh(const TriangleMesh &mesh, const std::vector<int> &near, const Vec3 &x, double radius, double reach)
      : mesh(mesh), x(x), same(SAME_DISTANCE * radius)
  {
    std::vector<BallFoot> all;
    for (const int triangle : near)
      if (const TrianglePoint point = mesh.triangles()[triangle].patch.closest(x); point.distance < reach)
        all.push_back({triangle, point, (1.0 / point.distance) * (x - point.at), radius - point.distance});
    for (const BallFoot &one : all)
      if (is_least(one)) feet.push_back(one);
    std::stable_sort(feet.begin(), feet.end(),
                     [](const BallFoot &a, const BallFoot &b) { return a.point.distance < b.point.distance; });
    // The nearer one counts of two in about one direction.
    for (std::size_t k = 0; k < feet.size(); ++k)
      for (std::size_t i = 0; i < k; ++i) {
        double unused;
        if (feet[i].part > 0.0)
          feet[k].part = std::min(feet[k].part, smooth_step(ONE_PATCH - dot(feet[i].n, feet[k].n), TWO_PATCHES, unused));
      }
    feet.erase(std::remove_if(feet.begin(), feet.end(), [](const BallFoot &one) { return one.part <= 0.0; }), feet.end());
  }
  std::vector<BallFoot> feet;

 private:
  // Whether no point of the surface around a point is nearer. A point of several triangles is that of the first one.
  bool is_least(const BallFoot &one) const
  {
    const TriangleMesh::Triangle &triangle = mesh.triangles()[one.triangle];
    const TrianglePoint &point = one.point;
    if (point.feature == TrianglePoint::INSIDE) return dot(one.n, triangle.patch.flat_normal()) > 0.0;
    if (point.feature == TrianglePoint::EDGE) return is_before(one, triangle.beyond[point.number]);
    const std::vector<int> around = mesh.around(one.triangle, point.number);
    return std::all_of(around.begin(), around.end(), [&](int other) { return is_before(one, other); });
  }
  bool is_before(const BallFoot &one, int other) const
  {
    if (other == one.triangle) return true;
    const double away = mesh.distance(other, x) - one.point.distance;
    return away > same || (one.triangle < other && away >= -same);
  }
  const TriangleMesh &mesh;
  Vec3 x;
  double same;
};

// The contacts that go on, for each foot: the nearest one that is not taken by a nearer foot; -1 where there is none.
std::vector<int> matched(const std::vector<BallFoot> &feet, const std::vector<Touch> &touches, double reach)
{
  std::vector<int> found;
  for (const BallFoot &foot : feet) {
    int nearest = -1;
    double least = reach * reach;
    for (int t = 0; t < static_cast<int>(touches.size()); ++t) {
      const Vec3 away = touches[t].place - foot.point.at;
      if (dot(away, away) < least && std::find(found.begin(), found.end(), t) == found.end())
        least = dot(away, away), nearest = t;
    }
    found.push_back(nearest);
  }
  return found;
}

int free_number(const std::vector<Touch> &touches)
{
  int number = 0;
  while (find_touch(touches, Touch::MOVING, number) != touches.end()) ++number;
  return number;
}

// Contacts of a round body with a mesh: `known` are those of its feet that go on, by their places in the list; -1 of new ones.
void press_feet(const TouchStep &step, std::vector<Touch> &touches, const std::vector<BallFoot> &feet,
                const std::vector<int> &known, const std::vector<Vec3> &places, Solid &round, Solid &host, const TouchLaw &law)
{
  std::vector<int> numbers;
  for (const int t : known) numbers.push_back(t < 0 ? -1 : touches[t].first);
  for (std::size_t t = 0; t < touches.size();)
    if (std::find(numbers.begin(), numbers.end(), touches[t].first) == numbers.end()) {
      step.let_go(touches[t]);
      touches.erase(touches.begin() + static_cast<std::ptrdiff_t>(t));
    } else {
      ++t;
    }
  for (std::size_t k = 0; k < feet.size(); ++k) {
    const BallFoot &foot = feet[k];
    const Vec3 n = host.in_space(foot.n), at = host.place(foot.point.at - foot.depth * foot.n);
    const int number = numbers[k] < 0 ? free_number(touches) : numbers[k];
    Touch *const touch = step.meet(touches, Touch::MOVING, number, law, round, &host, at, n, foot.depth, {});
    if (!touch) continue;
    touch->place = places[k];
    step.count_part(*touch, foot.part);
    step.press_between(*touch, law, round, &host, {at, n, foot.depth, foot.part}, nullptr);
  }
}

}    // namespace

// One contact for each smooth part of the surface: at its point that is closest to the middle of the ball.
void touch_ball_and_mesh(const TouchStep &step, SolidPair &pair, Solid &ball, Solid &host, const TouchLaw &law)
{
  if (pair.touches.empty() && (pair.asleep > 0.0 || is_far_from_mesh(pair, ball, host))) return;
  const TriangleMesh &mesh = host.shape.mesh();
  const Vec3 place = ball.place(ball.shape.middle()), x = host.in_body(place - host.centre);
  const double radius = ball.shape.radius(), margin = margin_of(ball, host);
  if (pair.known_for < 0.0) look_up_triangles(pair, mesh, x, radius, margin);
  if (pair.touches.empty() && pair.triangles.empty()) return;
  std::vector<Touch> &touches = pair.touches;
  const BallOnMesh on(mesh, pair.triangles, x, radius, radius + margin);
  std::vector<Vec3> places;
  for (const BallFoot &foot : on.feet) places.push_back(foot.point.at);
  press_feet(step, touches, on.feet, matched(on.feet, touches, SAME_PLACE * radius), places, ball, host, law);
}

// --- ellipsoids ---

namespace {

constexpr double SAME_WAY = 0.0;    // cosine between normals of which one may follow the other

// Where an ellipsoid touches a mesh with about this normal: as on other hosts, by the ball that fits it there, whose foot is the
// one with the nearest normal. False where there is none.
bool find_foot(const TriangleMesh &mesh, const std::vector<int> &near, const Solid &egg, const Solid &host, const Vec3 &middle,
               Vec3 n, BallFoot &found)
{
  constexpr int MOST_STEPS = 100;
  constexpr double ENOUGH = 1e-26, NEARLY = 1e-12;    // square of the way of the normal
  bool is_found = false;
  for (int k = 0; k < MOST_STEPS; ++k) {
    const EggPoint point(egg, egg.in_body(host.in_space(-1.0 * n)));
    const Vec3 centre = middle + host.in_body(egg.in_space(point.at)) + point.radius * n;
    const BallOnMesh on(mesh, near, centre, point.radius, HUGE_VAL);
    const BallFoot *nearest = nullptr;
    for (const BallFoot &foot : on.feet)
      if (dot(foot.n, n) > (nearest ? dot(nearest->n, n) : SAME_WAY)) nearest = &foot;
    if (!nearest) return false;
    const Vec3 way = nearest->n - n;
    found = *nearest;
    found.depth = point.radius - found.point.distance;
    found.part = 1.0;
    n = found.n;
    if (dot(way, way) < ENOUGH) return true;
    is_found = dot(way, way) < NEARLY;
  }
  return is_found;
}

}    // namespace

void touch_ellipsoid_and_mesh(const TouchStep &step, SolidPair &pair, Solid &egg, Solid &host, const TouchLaw &law)
{
  if (pair.touches.empty() && (pair.asleep > 0.0 || is_far_from_mesh(pair, egg, host))) return;
  const TriangleMesh &mesh = host.shape.mesh();
  const Vec3 middle = host.in_body(egg.place(egg.shape.middle()) - host.centre), &half = egg.shape.half_axes();
  const double longest = std::max({half.x, half.y, half.z}), margin = margin_of(egg, host);
  if (pair.known_for < 0.0) look_up_triangles(pair, mesh, middle, longest, margin);
  if (pair.touches.empty() && pair.triangles.empty()) return;
  // It goes on from its normals, and begins where its middle is nearest to a part of the surface.
  std::vector<BallFoot> feet;
  std::vector<int> known;
  std::vector<Vec3> normals;
  const auto take = [&](const Vec3 &start, int touch) {
    BallFoot foot;
    if (!find_foot(mesh, pair.triangles, egg, host, middle, start, foot)) return;
    if (touch < 0 && foot.depth > DEEPEST_BIRTH * egg.shape.thin()) return;
    for (const Vec3 &n : normals)
      if (dot(n, foot.n) > ONE_PATCH) return;
    feet.push_back(foot);
    known.push_back(touch);
    normals.push_back(foot.n);
  };
  for (std::size_t t = 0; t < pair.touches.size(); ++t) take(pair.touches[t].place, static_cast<int>(t));
  const BallOnMesh on(mesh, pair.triangles, middle, longest, longest);
  for (const BallFoot &foot : on.feet) take(foot.n, -1);
  press_feet(step, pair.touches, feet, known, normals, egg, host, law);
}

}    // namespace mdanim
