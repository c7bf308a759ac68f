// SPDX-License-Identifier: GPL-2.0-only
// Two polyhedra: corners of each in the other, edges across edges. The overlap of two faces is a polygon whose corners are these.

#include "rigid/mesh_host.h"
#include "rigid/pair.h"
#include "rigid/touch_corners.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mdanim {

static constexpr int MOST_CROSSINGS = 64;    // pairs of directions of edges that are tried to separate two bodies

static double thinner(const Solid &a, const Solid &b) { return std::min(a.shape.thin(), b.shape.thin()); }

namespace {

// Directions that may separate two polyhedra: normals of faces of a, of b, and across an edge of each.
class Directions {
 public:
  Directions(const Solid &a, const Solid &b) : a(a), b(b), p(a.shape.polyhedron()), q(b.shape.polyhedron())
  {
    faces_of_a = static_cast<int>(p.faces().size());
    faces = faces_of_a + static_cast<int>(q.faces().size());
    const int across = static_cast<int>(q.directions().size());
    crossings = static_cast<int>(p.directions().size()) * across;
    if (crossings > MOST_CROSSINGS) crossings = 0;
  }

  int size() const { return faces + 2 * crossings; }
  // Distance of the bodies along a direction: of its smallest between support planes; below 0 where it does not separate them.
  double gap(int number) const
  {
    if (number < faces_of_a) {
      const Polyhedron::Face &face = p.faces()[number];
      const Vec3 n = a.in_space(face.normal);
      return dot(n, b.centre - a.centre) - q.reach(-1.0 * b.in_body(n)) - face.at;
    }
    if (number < faces) {
      const Polyhedron::Face &face = q.faces()[number - faces_of_a];
      const Vec3 n = b.in_space(face.normal);
      return dot(n, a.centre - b.centre) - p.reach(-1.0 * a.in_body(n)) - face.at;
    }
    const int crossing = (number - faces) / 2, across = static_cast<int>(q.directions().size());
    const Vec3 one = a.in_space(p.directions()[crossing / across]), other = b.in_space(q.directions()[crossing % across]);
    const Vec3 n = (number - faces) % 2 ? cross(one, other) : cross(other, one);
    const double size = length(n);
    if (size < NEARLY_PARALLEL) return -1.0;
    return (dot(n, b.centre - a.centre) - q.reach(-1.0 * b.in_body(n)) - p.reach(a.in_body(n))) / size;
  }

 private:
  static constexpr double NEARLY_PARALLEL = 1e-3;
  const Solid &a, &b;
  const Polyhedron &p, &q;
  int faces_of_a, faces, crossings;
};

// Whether some direction separates the bodies. They then sleep until they may have closed the gap.
bool are_separated(SolidPair &pair, const Solid &a, const Solid &b)
{
  constexpr double SURELY = 0.99;
  const Directions directions(a, b);
  const auto separates = [&](int number) {
    const double gap = directions.gap(number);
    if (gap <= 0.0) return false;
    pair.axis = number;
    pair.asleep = SURELY * gap;
    return true;
  };
  if (pair.axis < directions.size() && separates(pair.axis)) return true;
  for (int number = 0; number < directions.size(); ++number)
    if (separates(number)) return true;
  return false;
}

// An edge in space.
struct PlacedEdge {
  Vec3 middle, along;
  double half;
  PlacedEdge(const Solid &solid, int number)
      : middle(solid.place(solid.shape.edges()[number].middle)), along(solid.in_space(solid.shape.edges()[number].along)),
        half(solid.shape.edges()[number].half), solid(solid), edge(solid.shape.edges()[number])
  {
  }
  Vec3 across(int face) const { return solid.in_space(edge.across[face]); }
  // Moves it, turned about a pivot by a small angle.
  void shift(const Vec3 &pivot, const Vec3 &move, const Vec3 &turn)
  {
    middle += move + cross(turn, middle - pivot);
    along = unit(along + cross(turn, along));
  }

 private:
  const Solid &solid;
  const Polyhedron::Edge &edge;
};

// The lines of two edges: where they are closest, along each from its middle, and n across both, out of the first.
struct EdgeCrossing {
  double cosine, square;    // of the angle between them, and of its sine
  double s, r;
  Vec3 n;
  double cone = 0.0;    // least of what n leads out of the four faces; below 0 where it is not a normal of the edges
  double outward = 0.0;
  double depth = 0.0;

  EdgeCrossing(const PlacedEdge &a, const PlacedEdge &b)
  {
    const Vec3 between = a.middle - b.middle;
    cosine = dot(a.along, b.along);
    square = 1.0 - cosine * cosine;
    const double along_a = dot(a.along, between), along_b = dot(b.along, between);
    s = (cosine * along_b - along_a) / square;
    r = (along_b - cosine * along_a) / square;
  }
  void find_normal(const PlacedEdge &a, const PlacedEdge &b)
  {
    n = (1.0 / std::sqrt(square)) * cross(a.along, b.along);
    const Vec3 one = a.across(0), other = a.across(1);
    outward = -dot(n, one + other);
    if (outward < 0.0) n = -1.0 * n, outward = -outward;
    cone = std::min(std::min(-dot(n, one), -dot(n, other)), std::min(dot(n, b.across(0)), dot(n, b.across(1))));
    depth = dot((a.middle + s * a.along) - (b.middle + r * b.along), n);
  }
};

// The part of a crossing that counts: ramps at the ends of edges, and for edges that are nearly parallel. Ramps go from the ends
// inward, where corners bear what edges do not. Where a corner cannot be below a side, as it passes over an edge, they are about
// the ends, so that the crossing with its next edge counts by as much more as this one counts less.
struct CrossingPart {
  double of_a, of_b, of_angle, slope_a, slope_b, slope_angle;
  CrossingPart(const PlacedEdge &a, const PlacedEdge &b, const EdgeCrossing &at, double wa, double wb, bool over_ends)
      : of_a(smooth_step(a.half - std::fabs(at.s) - (over_ends ? 0.0 : wa), wa, slope_a)),
        of_b(smooth_step(b.half - std::fabs(at.r) - (over_ends ? 0.0 : wb), wb, slope_b)),
        of_angle(smooth_step(at.square - FADED, FADES, slope_angle))
  {
  }
  double value() const { return of_a * of_b * of_angle; }
};

// Whether an edge, longer by `more` at both ends, goes through a host that is thicker by `by`.
bool passes(const Solid &host, const PlacedEdge &edge, double more, double by)
{
  const Vec3 x = host.in_body(edge.middle - host.centre), way = host.in_body(edge.along);
  if (host.shape.kind() == SolidShape::MESH) {
    Box box;
    for (const double end : {-1.0, 1.0}) {
      const Vec3 at = x + (end * (edge.half + more)) * way;
      box.include(&at.x);
    }
    return !host.shape.mesh().edges_near(box.grown(by)).empty();
  }
  double low = -edge.half - more, high = edge.half + more;
  for (const Polyhedron::Face &face : host.shape.polyhedron().faces()) {
    const double room = face.at + by - dot(face.normal, x), speed = dot(face.normal, way);
    if (std::fabs(speed) < 1e-12) {
      if (room < 0.0) return false;
    } else if (speed > 0.0) {
      high = std::min(high, room / speed);
    } else {
      low = std::max(low, room / speed);
    }
    if (low > high) return false;
  }
  return true;
}

constexpr double PARALLEL = 1e-4;                   // square of a sine below which two edges have no crossing
constexpr double CROSSED = 0.05;                    // the same: below it nothing is said of a later time
constexpr double AT_BIRTH = -0.1, AT_END = -0.4;    // how far n may be out of the cones
constexpr double SHALLOW_BIRTH = 0.06;              // over the thinnest part
constexpr double OVER_ENDS = 0.02;                  // how far n is within the cones where crossings count beyond ends

std::vector<int> edges_near(const Solid &one, const Solid &host, const std::vector<Touch> &touches, bool of_first, double margin)
{
  std::vector<int> near, numbers(one.shape.edges().size());
  std::iota(numbers.begin(), numbers.end(), 0);
  const auto is_known = [&](int e) {
    return std::any_of(touches.begin(), touches.end(), [&](const Touch &touch) {
      return touch.kind == Touch::EDGES && (of_first ? touch.first : touch.second) == e;
    });
  };
  if (one.shape.kind() == SolidShape::MESH) {
    numbers = one.shape.mesh().edges_near(box_around(one, host, ramp_of(one) + margin));
    for (const Touch &touch : touches)
      if (touch.kind == Touch::EDGES) numbers.push_back(of_first ? touch.first : touch.second);
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  }
  for (const int e : numbers)
    if (!one.shape.edges()[e].covered && (is_known(e) || passes(host, PlacedEdge(one, e), ramp_of(one) + margin, margin)))
      near.push_back(e);
  return near;
}

// Whether the balls around two edges are this far apart.
bool are_apart(const PlacedEdge &a, const PlacedEdge &b, double by)
{
  const Vec3 between = a.middle - b.middle;
  const double reach = a.half + b.half + by;
  return dot(between, between) > reach * reach;
}

// Pairs of edges that may touch before both bodies have moved by the margin.
void look_up_edges(SolidPair &pair, const Solid &a, const Solid &b, double margin)
{
  pair.edges.clear();
  const std::vector<int> of_a = edges_near(a, b, pair.touches, true, margin);
  if (of_a.empty()) return;
  const std::vector<int> of_b = edges_near(b, a, pair.touches, false, margin);
  const double turn = 2.0 * margin / std::min(a.shape.bound(), b.shape.bound());
  for (const int i : of_a) {
    const PlacedEdge one(a, i);
    for (const int j : of_b) {
      if (find_touch(pair.touches, Touch::EDGES, i, j) == pair.touches.end()) {
        const PlacedEdge other(b, j);
        if (is_with_mesh(a, b) && are_apart(one, other, ramp_of(a) + ramp_of(b) + margin)) continue;
        EdgeCrossing at(one, other);
        if (at.square < FADED - FADES - 2.0 * turn) continue;
        if (at.square > PARALLEL) {
          const double sine = std::sqrt(at.square), slack = 4.0 * margin / sine, tilt = 2.0 * turn / sine;
          if (std::fabs(at.s) > one.half + ramp_of(a) + slack || std::fabs(at.r) > other.half + ramp_of(b) + slack) continue;
          at.find_normal(one, other);
          if (at.outward > 2.0 * tilt && (at.cone < AT_BIRTH - tilt || at.depth < -margin - slack * tilt)) continue;
        }
      }
      pair.edges.push_back({i, j});
    }
  }
}

// Anchors along both edges where the surface of the first body ran over that of the other: ran = s one - r other, beside n.
void run_along(Vec3 &anchor, const Vec3 &ran, const Vec3 &one, const Vec3 &other, const EdgeCrossing &at)
{
  const double by_one = dot(ran, one), by_other = dot(ran, other);
  anchor.x += (by_one - at.cosine * by_other) / at.square;
  anchor.y += (at.cosine * by_one - by_other) / at.square;
}

// How far both bodies may go until edges begin to touch that do not cross, or not with a normal of both, or above each other:
// after a way w they have moved along each other by 4 w/sine at most, and n has turned by 4 w/(sine size). Half of that, to be
// sure; 0 where the edges are nearly parallel.
double way_to_cross(const EdgeCrossing &at, double apart)
{ return at.square < CROSSED ? 0.0 : 0.125 * apart * std::sqrt(at.square); }

double way_to_meet(const Solid &a, const Solid &b, const EdgeCrossing &at)
{
  if (at.square < CROSSED) return 0.0;
  const double sine = std::sqrt(at.square), turns = 0.25 * sine * std::min(a.shape.bound(), b.shape.bound());
  const double by_turning = std::min(0.5 * at.outward, AT_BIRTH - at.cone) * turns;
  // The depth changes by w + (4 w/sine) (w/turns).
  const double above = std::max(-at.depth, 0.0), bends = 4.0 / (sine * turns);
  const double by_depth = std::min(0.5 * at.outward * turns, 2.0 * above / (1.0 + std::sqrt(1.0 + 4.0 * bends * above)));
  return 0.5 * std::max({by_turning, by_depth, 0.0});
}

// Two edges that cross with a normal of both.
class CrossedEdges {
 public:
  const double part;    // that counts

  CrossedEdges(const TouchStep &step, const TouchLaw &law, Solid &a, Solid &b, const PlacedEdge &one, const PlacedEdge &other,
               const EdgeCrossing &at, bool over_ends)
      : CrossedEdges(step, law, a, b, one, other, at, over_ends,
                     CrossingPart(one, other, at, 0.5 * ramp_of(a), 0.5 * ramp_of(b), over_ends))
  {
  }
  Meeting meeting() const { return {x, -1.0 * at.n, at.depth, part}; }
  bool may_begin() const { return part > 0.0 && (at.depth <= SHALLOW_BIRTH * thinner(a, b) || step.may_be_deep()); }
  Touch begun(int first, int second) const
  {
    Touch touch = step.born(Touch::EDGES, law, a, &b, x, -1.0 * at.n);
    touch.first = first;
    touch.second = second;
    touch.over_ends = over_ends;
    touch.anchor = {at.s, at.r, 0.0};
    const Vec3 relative = TouchStep::relative_velocity(a, &b, x);
    const double back = -A_STEP * step.time_step();
    step.begin(touch, a, &b, meeting(), at.depth + back * dot(relative, at.n) <= 0.0 || came_over_ramp(relative, back));
    return touch;
  }
  void press(Touch &touch) const
  {
    const ContactLaw its_law = step.law_of(touch, law);
    ContactForce<double> push = step.pressure(touch, a, &b, its_law, part, at.depth);
    Vec3 force = (-push.press) * at.n + push_aside(push.surface_energy);
    if (law.friction > 0.0) {
      rub(touch, its_law, push);
      force += push.drag;
    }
    step.apply(a, &b, x, force);
    step.book(a, &b, touch, meeting(), push);
  }

 private:
  CrossedEdges(const TouchStep &step, const TouchLaw &law, Solid &a, Solid &b, const PlacedEdge &one, const PlacedEdge &other,
               const EdgeCrossing &at, bool over_ends, const CrossingPart &counts)
      : part(counts.value()), step(step), law(law), a(a), b(b), one(one), other(other), at(at), over_ends(over_ends),
        counts(counts), x(0.5 * ((one.middle + at.s * one.along) + (other.middle + at.r * other.along)))
  {
  }
  bool came_over_ramp(const Vec3 &relative, double back) const
  {
    if (part >= LITTLE || at.depth >= SHALLOW * thinner(a, b)) return false;
    PlacedEdge before = one;
    before.shift(x, back * relative, back * (a.spin - b.spin));
    const EdgeCrossing was(before, other);
    return was.square < PARALLEL ||
           CrossingPart(before, other, was, 0.5 * ramp_of(a), 0.5 * ramp_of(b), over_ends).value() <= 0.0;
  }
  void turn(const Vec3 &torque) const { step.turn(a, &b, torque); }
  // The force by the gradient of `part`: s and r move by (u - cosine w)/sine^2 and -(w - cosine u)/sine^2 with the first body.
  Vec3 push_aside(double energy) const
  {
    const double by_s = energy * (at.s > 0.0 ? -counts.slope_a : counts.slope_a) * counts.of_b * counts.of_angle,
                 by_r = energy * counts.of_a * (at.r > 0.0 ? -counts.slope_b : counts.slope_b) * counts.of_angle,
                 by_angle = energy * counts.of_a * counts.of_b * counts.slope_angle;
    Vec3 aside;
    if (by_s != 0.0 || by_r != 0.0) {
      aside =
          (by_s / at.square) * (one.along - at.cosine * other.along) - (by_r / at.square) * (other.along - at.cosine * one.along);
      // They also move as the edges turn towards n.
      turn((0.5 * at.depth) * cross(at.n, aside) + (at.depth * (by_s + at.cosine * by_r) / at.square) * cross(one.along, at.n));
    }
    if (by_angle != 0.0) turn((2.0 * at.cosine * by_angle) * cross(one.along, other.along));
    return aside;
  }
  // Friction from anchors on both edges: its spring acts midway between them.
  void rub(Touch &touch, const ContactLaw &its_law, ContactForce<double> &push) const
  {
    const Vec3 ran = step.ran(a, &b), &u = one.along, &w = other.along;
    run_along(touch.anchor, ran, u, w, at);
    const Vec3 away = (touch.anchor.x - at.s) * u - (touch.anchor.y - at.r) * w;
    step.friction(touch, its_law, part, away, at.n, ran, push);
    touch.anchor = {at.s + push.kept * (touch.anchor.x - at.s), at.r + push.kept * (touch.anchor.y - at.r), 0.0};
    const Vec3 between = 0.5 * ((one.middle + touch.anchor.x * u) + (other.middle + touch.anchor.y * w));
    step.apply(a, &b, between, push.pull);
    // The way from one anchor to the other has a part along n, which turns with both edges.
    const double lever = (dot(cross(u, w), at.n) > 0.0 ? 1.0 : -1.0) * at.depth / std::sqrt(at.square);
    turn(lever * (at.cosine * push.pull - 0.5 * (dot(push.pull, u) * w + dot(push.pull, w) * u)));
  }

  const TouchStep &step;
  const TouchLaw &law;
  Solid &a, &b;
  const PlacedEdge &one, &other;
  const EdgeCrossing &at;
  const bool over_ends;
  const CrossingPart counts;
  const Vec3 x;
};

void touch_edges(const TouchStep &step, SolidPair &pair, Solid &a, Solid &b, const TouchLaw &law)
{
  const double wa = 0.5 * ramp_of(a), wb = 0.5 * ramp_of(b);
  for (NearFeatures &near : pair.edges) {
    if (pair.known_for > near.until) continue;
    const PlacedEdge one(a, near.first), other(b, near.second);
    EdgeCrossing at(one, other);
    if (at.square < PARALLEL) continue;
    const auto found = find_touch(pair.touches, Touch::EDGES, near.first, near.second);
    const bool is_known = found != pair.touches.end();
    const double beyond = std::max(std::fabs(at.s) - one.half - wa, std::fabs(at.r) - other.half - wb);
    if (!is_known && beyond >= 0.0) {
      near.until = pair.known_for - way_to_cross(at, beyond);
      continue;
    }
    at.find_normal(one, other);
    if (!is_known && (at.cone < AT_BIRTH || at.depth <= 0.0)) {
      near.until = pair.known_for - way_to_meet(a, b, at);
      continue;
    }
    const CrossedEdges edges(step, law, a, b, one, other, at, is_known ? found->over_ends != 0.0 : at.cone > OVER_ENDS);
    if (!is_known) {
      if (!edges.may_begin()) continue;
      pair.touches.push_back(edges.begun(near.first, near.second));
      edges.press(pair.touches.back());
    } else if (at.depth <= 0.0 || edges.part <= 0.0) {
      step.part(*found, a, &b, edges.meeting());
    } else if (at.cone < AT_END) {
      step.let_go(*found, at.depth, edges.part);
      pair.touches.erase(found);
    } else {
      edges.press(*found);
    }
  }
}

}    // namespace

void touch_polyhedra(const TouchStep &step, SolidPair &pair, Solid &a, Solid &b, const TouchLaw &law)
{
  if (pair.touches.empty() &&
      (pair.asleep > 0.0 || (is_with_mesh(a, b) ? is_far_from_mesh(pair, a, b) : are_separated(pair, a, b))))
    return;
  const double margin = margin_of(a, b);
  const bool stale = pair.known_for < 0.0;
  if (stale) look_up_sides(pair, a, b, margin);
  touch_corners_in(step, pair, false, a, b, law, margin, stale);
  touch_corners_in(step, pair, true, b, a, law, margin, stale);
  if (stale) look_up_edges(pair, a, b, margin);
  touch_edges(step, pair, a, b, law);
}

}    // namespace mdanim
