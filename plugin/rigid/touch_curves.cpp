// SPDX-License-Identifier: GPL-2.0-only
// Two bodies of which one is a cylinder, a cone or a torus: corners in sides, rims on flat sides, curves across curves. Each
// contact has an energy that is a function of where both bodies are, and its force is the gradient of that.

#include "rigid/mesh_host.h"
#include "rigid/pair.h"
#include "rigid/round_host.h"
#include "rigid/touch_corners.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace mdanim {

namespace {

constexpr double FADED_ON_CONES = 0.1, FADES_ON_CONES = 0.08;    // on cones places run along faster
constexpr double AT_BIRTH = -0.1, AT_END = -0.4;                 // how far a normal may be out of the cones of sharp curves
constexpr double SHALLOW_BIRTH = 0.06;                           // over the thinnest part
constexpr double SAME_PLACE = 0.25;    // over the radius of a circle: how far a contact may move along it in a step

// A small motion: turned about a pivot, then moved.
struct Shift {
  Vec3 pivot, move, turn;
  Curve operator()(const Curve &curve) const
  {
    const auto direction = [this](const Vec3 &a) {
      const Vec3 now = a + cross(turn, a);
      const double size = length(now);
      return size > 0.0 ? (1.0 / size) * now : now;
    };
    const auto place = [this](const Vec3 &p) { return p + move + cross(turn, p - pivot); };
    return curve.moved(place, direction);
  }
};

// The gradient of a part that counts by differences: part(shift) is that of the first body after a small motion.
template <class Part> PartSlope slope_of(const Part &part, const Vec3 &pivot, double size)
{
  constexpr double SMALL = 1e-6;
  PartSlope found;
  const auto by = [&](bool turns, int axis) {
    const double h = turns ? SMALL : SMALL * size;
    const Vec3 way = h * Vec3{axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0};
    const auto shifted = [&](double sign) {
      const Vec3 motion = sign * way;
      return part(Shift{pivot, turns ? Vec3{} : motion, turns ? motion : Vec3{}});
    };
    return (shifted(1.0) - shifted(-1.0)) / (2.0 * h);
  };
  found.by_place = {by(false, 0), by(false, 1), by(false, 2)};
  found.by_turn = {by(true, 0), by(true, 1), by(true, 2)};
  return found;
}

bool is_between(double part) { return part > 0.0 && part < 1.0; }

// The motion of `a` over `b` backwards by one step, about x.
Shift step_before(const TouchStep &step, const Solid &a, const Solid &b, const Vec3 &x)
{
  const double back = -A_STEP * step.time_step();
  return {x, back * TouchStep::relative_velocity(a, &b, x), back * (a.spin - b.spin)};
}

// --- rims on flat sides ---

constexpr int ON_RIM = 12, LOWEST = ON_RIM, RIM_POINTS = ON_RIM + 1;
constexpr double SHARE = 0.5;    // of the stiffness of a contact that each of the points on a rim has
constexpr double HALF_ROOT_3 = 0.86602540378443864676;
constexpr double COSINE[ON_RIM] = {1.0,  HALF_ROOT_3,  0.5,  0.0, -0.5, -HALF_ROOT_3,
                                   -1.0, -HALF_ROOT_3, -0.5, 0.0, 0.5,  HALF_ROOT_3};

// A circle touches a flat side with twelve points of it, fixed in its body, where it is nearly level, and with its lowest one
// where it leans. All in the frame of the host.
template <class Host> class RimOnSide {
 public:
  RimOnSide(const Host &host, int side, const Curve &circle)
      : n(host.normal(side, {})), host(host), side(side), circle(circle), level(dot(n, circle.along)),
        leans(smooth_step(1.0 - level * level - FADED, FADES, leans_slope))
  {
  }

  const Vec3 n;
  double share(int k) const { return k < ON_RIM ? 1.0 - leans : leans; }
  Vec3 out(int k) const
  {
    if (k < ON_RIM) return COSINE[k] * circle.any + COSINE[(k + 9) % ON_RIM] * cross(circle.along, circle.any);
    const Vec3 down = level * circle.along - n;
    const double size = length(down);
    return size > 0.0 ? (1.0 / size) * down : circle.any;
  }
  Vec3 point(int k) const { return circle.middle + circle.size * out(k) - circle.thick * n; }
  double depth(const Vec3 &x) const { return host.depth(side, x); }
  double part(int k, const Vec3 &x, Vec3 &slope) const { return share(k) * host.part(side, x, slope); }
  // The gradient of a part, with that of the host's part at x.
  PartSlope slope(int k, const Vec3 &x, const Vec3 &slope_of_host, double size) const
  {
    if (k == LOWEST)
      return slope_of(
          [&](const Shift &shift) {
            const Curve moved = shift(circle);
            const RimOnSide now(host, side, moved);
            Vec3 unused;
            return now.part(k, now.point(k), unused);
          },
          x, size);
    Vec3 unused;
    return {(1.0 - leans) * slope_of_host, (2.0 * level * leans_slope * host.part(side, x, unused)) * cross(circle.along, n)};
  }
  // How far the side may lean out of what the rim turns towards it.
  double cone(int k) const
  {
    if (!circle.is_sharp()) return 1.0;
    const Vec3 e = out(k);
    return std::min(-dot(n, e), dot(n, circle.into_side(e)));
  }
  // Whether no point can begin to touch: all are above the side, too deep below it, or turned away from it.
  bool is_far(double deepest) const
  {
    const double middle = host.depth(side, circle.middle), around = circle.size * std::sqrt(std::max(0.0, 1.0 - level * level));
    return middle + around + circle.thick <= 0.0 || middle - around - circle.thick > deepest ||
           (circle.is_sharp() && highest_cone() < AT_BIRTH);
  }
  // Whether a point that comes belongs to this side, as corners do.
  bool is_mine(int k, const Vec3 &x, double deepest) const
  {
    Polyhedron::Corner corner{x, {}, {}};
    if (circle.is_sharp()) {
      const Vec3 e = out(k), u = cross(circle.along, e);
      corner.ways = {-1.0 * e, circle.into_side(e), u, -1.0 * u};
    } else {
      const Vec3 u = unit(cross(n, std::fabs(n.x) < 0.6 ? Vec3{1.0, 0.0, 0.0} : Vec3{0.0, 1.0, 0.0})), w = cross(n, u);
      corner.ways = {n, u, -1.0 * u, w, -1.0 * w};
    }
    return is_born_below(host, side, corner, [](const Vec3 &a) { return a; }, x, deepest);
  }

 private:
  const Host &host;
  int side;
  const Curve &circle;
  double highest_cone() const
  {
    return circle.narrows * std::sqrt(std::max(0.0, 1.0 - level * level)) -
           std::sqrt(1.0 - circle.narrows * circle.narrows) * level;
  }
  double level, leans_slope, leans;
};

template <class Host>
void touch_rim(const TouchStep &step, std::vector<Touch> &touches, Touch::TouchKind kind, int number, const Curve &circle,
               const Host &host, int side, Solid &a, Solid &b, const TouchLaw &law)
{
  const RimOnSide<Host> on(host, side, circle);
  const double deepest = DEEPEST_BIRTH * b.shape.thin();
  const bool is_far = on.is_far(deepest),
             is_known = std::any_of(touches.begin(), touches.end(), [&](const Touch &one) {
               return one.kind == kind && one.side == side && one.first >= number && one.first < number + RIM_POINTS;
             });
  if (is_far && !is_known) return;
  const TouchLaw share{SHARE * law.stiffness, law.friction, law.damping, law.rolling};
  for (int k = 0; k < RIM_POINTS; ++k) {
    const auto is_this = [&](const Touch &one) { return one.kind == kind && one.first == number + k && one.side == side; };
    auto found = is_known ? std::find_if(touches.begin(), touches.end(), is_this) : touches.end();
    const bool is_new = found == touches.end();
    if (is_new && on.share(k) <= 0.0) continue;
    const Vec3 own = on.point(k);
    const double depth = on.depth(own);
    if (is_new && depth <= 0.0) continue;
    Vec3 slope_of_host;
    const double part = on.part(k, own, slope_of_host), cone = on.cone(k);
    const Meeting at{b.place(own), b.in_space(on.n), depth, part};
    if (is_new) {
      if (part <= 0.0 || cone < AT_BIRTH || host.outside(own) >= ramp_of(b) || !on.is_mine(k, own, deepest)) continue;
      // All points on a rim yield together, as its middle.
      const Vec3 middle = b.place(circle.middle);
      Touch touch = k < ON_RIM ? step.born(kind, share, ON_RIM * (a.yields_at(middle, at.n) + b.yields_at(middle, at.n)))
                               : step.born(kind, law, a, &b, at.x, at.n);
      touch.first = number + k;
      touch.side = side;
      Shift back = step_before(step, a, b, at.x);
      back = {own, b.in_body(back.move), b.in_body(back.turn)};
      const Curve moved = back(circle);
      const RimOnSide<Host> before(host, side, moved);
      const Vec3 last = before.point(k);
      Vec3 unused;
      step.begin(touch, a, &b, at,
                 before.depth(last) <= 0.0 ||
                     (depth < SHALLOW * b.shape.thin() && part < LITTLE && before.part(k, last, unused) <= 0.0));
      touches.push_back(touch);
      found = touches.end() - 1;
    } else if (depth <= 0.0 || part <= 0.0 || cone < AT_END) {
      if (depth <= 0.0 || part <= 0.0) {
        step.part(*found, a, &b, at);
      } else {
        step.let_go(*found, depth, part);
        touches.erase(found);
      }
      continue;
    }
    if (is_between(part)) {
      PartSlope slope = on.slope(k, own, slope_of_host, b.shape.thin());
      slope.by_place = b.in_space(slope.by_place);
      slope.by_turn = b.in_space(slope.by_turn);
      step.press_between(*found, law, a, &b, at, &slope);
    } else {
      step.press_between(*found, law, a, &b, at, nullptr);
    }
  }
}

template <class Host>
void touch_rims(const TouchStep &step, std::vector<Touch> &touches, Touch::TouchKind kind, Solid &a, Solid &b, const Host &host,
                const TouchLaw &law)
{
  const Vec3 between = b.in_body(a.centre - b.centre);
  const auto turn = [&](const Vec3 &own) { return b.in_body(a.in_space(own)); };
  const auto place = [&](const Vec3 &own) { return between + turn(own); };
  int number = 0;
  for (const Curve &curve : a.shape.curves()) {
    if (!curve.is_circle) continue;
    const Curve circle = curve.moved(place, turn);
    host.each_flat_side([&](int side) { touch_rim(step, touches, kind, number, circle, host, side, a, b, law); });
    number += RIM_POINTS;
  }
}

// Corners and rims of `a` in `b`.
void touch_sides(const TouchStep &step, SolidPair &pair, bool of_other, Solid &a, Solid &b, const TouchLaw &law, double margin,
                 bool stale)
{
  touch_corners_in(step, pair, of_other, a, b, law, margin, stale);
  const Touch::TouchKind kind = of_other ? Touch::MOVING_OF_OTHER : Touch::MOVING;
  const auto with = [&](const auto &host) { touch_rims(step, pair.touches, kind, a, b, host, law); };
  if (b.shape.kind() == SolidShape::POLYHEDRON)
    with(PolyhedronHost(b.shape.polyhedron(), ramp_of(b)));
  else if (b.shape.kind() == SolidShape::MESH)
    with(MeshHost(b.shape.mesh(), ramp_of(b), pair.sides[of_other]));
  else
    with(RoundHost(b.shape, ramp_of(b)));
}

// --- curves across curves ---

Curve placed(const Solid &solid, int number)
{
  return solid.shape.curves()[number].moved([&](const Vec3 &own) { return solid.place(own); },
                                            [&](const Vec3 &own) { return solid.in_space(own); });
}

class CurveCrossing {
 public:
  CurveCrossing(const Curve &a, const Curve &b, double ramp_a, double ramp_b) : a(a), b(b), ramp_a(ramp_a), ramp_b(ramp_b) {}

  struct State {
    CurveMeeting points;
    Meeting at;           // n pushes the first body
    double cone = 1.0;    // least of what -n leads out of the faces about sharp curves; below 0 where it is not a normal of them
  };
  // Nothing where it is not clear which way they touch.
  std::optional<State> state(const CurveMeeting &points) const
  {
    State found;
    found.points = points;
    const CurvePoint &p = points.a, &q = points.b;
    const Vec3 from = p.at - q.at;
    const double far = length(from), both = p.radius + q.radius;
    if (both > 0.0) {
      if (!(far > 0.0)) return std::nullopt;
      found.at.n = (1.0 / far) * from;
      found.at.depth = both - far;
      // On the true surface of what rolls over an edge; between two surfaces nearer to that of the thinner one.
      found.at.x = p.radius == 0.0   ? q.at + q.radius * found.at.n
                   : q.radius == 0.0 ? p.at - p.radius * found.at.n
                                     : p.at - (p.radius * far / both) * found.at.n;
    } else {
      const Vec3 across = cross(p.tangent, q.tangent);
      const double sine = length(across);
      if (!(sine * sine > FADED - FADES)) return std::nullopt;
      found.at.n = (1.0 / sine) * across;
      if (dot(found.at.n, p.across[0] + p.across[1]) < 0.0) found.at.n = -1.0 * found.at.n;
      found.at.depth = -dot(from, found.at.n);
      found.at.x = 0.5 * (p.at + q.at);
    }
    const auto least = [](const Vec3 &n, const Vec3 *across) { return std::min(dot(n, across[0]), dot(n, across[1])); };
    if (a.is_sharp()) found.cone = std::min(found.cone, least(found.at.n, p.across));
    if (b.is_sharp()) found.cone = std::min(found.cone, least(-1.0 * found.at.n, q.across));
    found.at.part = part(points);
    return found;
  }
  // It fades from the ends of lines inward, as edges do; about those of a line with a radius across which there is a rim; and
  // where two curves are nearly parallel, of which one is not sharp or both are.
  double part(const CurveMeeting &points) const
  {
    double unused, part = 1.0;
    if (a.is_egg || b.is_egg) return 1.0;
    if (!a.is_circle) part *= at_ends(a, points.a, ramp_a, b);
    if (!b.is_circle) part *= at_ends(b, points.b, ramp_b, a);
    if (a.is_circle != b.is_circle && !(a.is_sharp() && b.is_sharp())) return part;
    if (a.is_circle && !(a.is_sharp() && b.is_sharp())) return part;
    const Vec3 across = points.a.at - points.b.at, u = on_surface(a, points.a, across), w = on_surface(b, points.b, across);
    const double cosine = dot(u, w), square = 1.0 - cosine * cosine;
    if (a.taper != 0.0 || b.taper != 0.0) return part * smooth_step(square - FADED_ON_CONES, FADES_ON_CONES, unused);
    return part * smooth_step(square - FADED, FADES, unused);
  }

 private:
  // The direction of the line on the surface of a cone, below a contact that pushes along n.
  static Vec3 on_surface(const Curve &curve, const CurvePoint &point, const Vec3 &n)
  {
    if (curve.taper == 0.0) return point.tangent;
    return unit(point.tangent - (dot(point.tangent, n) / dot(n, n)) * n);
  }
  static double at_ends(const Curve &line, const CurvePoint &point, double ramp, const Curve &other)
  {
    double unused;
    const double inside = line.size - std::fabs(point.place);
    if (line.taper * point.place > 0.0) return smooth_step(inside - ramp, ramp, unused);    // towards the tip
    if (other.is_circle && !line.is_sharp()) return smooth_step(inside, ramp, unused);
    return smooth_step(inside - 0.5 * ramp, 0.5 * ramp, unused);
  }
  const Curve &a, &b;
  double ramp_a, ramp_b;
};

class CurvePair {
 public:
  CurvePair(const TouchStep &step, std::vector<Touch> &touches, Solid &one, Solid &other, int i, int j, const TouchLaw &law)
      : step(step), touches(touches), one(one), other(other), law(law), i(i), j(j), a(placed(one, i)), b(placed(other, j)),
        ramp_a(ramp_of(one)), ramp_b(ramp_of(other))
  {
  }

  void touch()
  {
    const CurveCrossing crossing(a, b, ramp_a, ramp_b);
    std::vector<std::optional<CurveCrossing::State>> found;
    for (const CurveMeeting &points : meetings(a, b)) found.push_back(crossing.state(points));
    for (std::size_t t = 0; t < touches.size();) {
      Touch &known = touches[t];
      if (known.kind != Touch::CURVES || known.first != i || known.second != j || go_on(known, found))
        ++t;
      else
        touches.erase(touches.begin() + static_cast<std::ptrdiff_t>(t));
    }
    for (const std::optional<CurveCrossing::State> &state : found)
      if (state) begin(*state);
  }

 private:
  // The place of a known contact among those found, which takes it out. Whether it stays in the list.
  bool go_on(Touch &known, std::vector<std::optional<CurveCrossing::State>> &found)
  {
    std::optional<CurveCrossing::State> *nearest = nullptr;
    const double reach =
        a.is_circle || b.is_circle ? SAME_PLACE * std::max(a.is_circle ? a.size : 0.0, b.is_circle ? b.size : 0.0) : HUGE_VAL;
    double least = reach * reach;
    for (std::optional<CurveCrossing::State> &state : found) {
      if (!state) continue;
      const Vec3 away = in_host(state->at.x) - known.place;
      if (dot(away, away) < least) least = dot(away, away), nearest = &state;
    }
    if (!nearest) {
      step.let_go(known);
      return false;
    }
    const CurveCrossing::State state = **nearest;
    nearest->reset();
    if (state.at.depth > 0.0 && state.at.part > 0.0 && state.cone >= AT_END) {
      press(known, state);
      return true;
    }
    if (state.at.depth <= 0.0 || state.at.part <= 0.0) {
      step.part(known, one, &other, state.at);
      return true;
    }
    step.let_go(known, state.at.depth, state.at.part);
    return false;
  }
  void begin(const CurveCrossing::State &state)
  {
    const Meeting &at = state.at;
    if (at.depth <= 0.0 || at.part <= 0.0 || state.cone < AT_BIRTH) return;
    const double thin = std::min(one.shape.thin(), other.shape.thin());
    // Rims on the far sides of both have opposite normals too.
    if (at.depth > SHALLOW_BIRTH * thin && (!step.is_first() || a.is_sharp() || b.is_sharp())) return;
    Touch touch = step.born(Touch::CURVES, law, one, &other, at.x, at.n);
    touch.first = i;
    touch.second = j;
    const double rises = dot(TouchStep::relative_velocity(one, &other, at.x), at.n);
    const bool came =
        at.depth + A_STEP * step.time_step() * rises <= 0.0 ||
        (at.part < LITTLE && at.depth < SHALLOW * thin && part_after(step_before(step, one, other, at.x), state.points) <= 0.0);
    step.begin(touch, one, &other, at, came);
    touches.push_back(touch);
    press(touches.back(), state);
  }
  void press(Touch &touch, const CurveCrossing::State &state)
  {
    touch.place = in_host(state.at.x);
    if (!is_between(state.at.part)) return step.press_between(touch, law, one, &other, state.at, nullptr);
    const PartSlope slope = slope_of([&](const Shift &shift) { return part_after(shift, state.points); }, state.at.x,
                                     std::min(one.shape.thin(), other.shape.thin()));
    step.press_between(touch, law, one, &other, state.at, &slope);
  }
  double part_after(const Shift &shift, const CurveMeeting &points) const
  {
    const Curve moved = shift(a);
    return CurveCrossing(moved, b, ramp_a, ramp_b).part(meeting_near(moved, b, points));
  }
  Vec3 in_host(const Vec3 &x) const { return other.in_body(x - other.centre); }

  const TouchStep &step;
  std::vector<Touch> &touches;
  Solid &one, &other;
  const TouchLaw &law;
  int i, j;
  Curve a, b;
  double ramp_a, ramp_b;
};

// Numbers of the curves of one that may be near the other, among them all that touch it.
std::vector<int> curves_near(const Solid &one, const Solid &other, double more, const std::vector<Touch> &touches, bool of_first)
{
  std::vector<int> found(one.shape.curves().size());
  std::iota(found.begin(), found.end(), 0);
  const auto is_covered = [&](int number) { return one.shape.curves()[number].covered; };
  found.erase(std::remove_if(found.begin(), found.end(), is_covered), found.end());
  if (one.shape.kind() != SolidShape::MESH) return found;
  found = one.shape.mesh().edges_near(box_around(one, other, more));
  for (const Touch &touch : touches)
    if (touch.kind == Touch::CURVES) found.push_back(of_first ? touch.first : touch.second);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

// Curves that may touch before both bodies have moved by the margin.
void look_up_curves(SolidPair &pair, const Solid &a, const Solid &b, double margin)
{
  const double slack = margin + SHALLOW_BIRTH * std::min(a.shape.thin(), b.shape.thin());
  pair.edges.clear();
  const std::vector<int> of_b = curves_near(b, a, slack, pair.touches, false);
  for (const int i : curves_near(a, b, slack, pair.touches, true)) {
    const Curve one = placed(a, i);
    for (const int j : of_b) {
      const Curve other = placed(b, j);
      if (least_gap(one, other) < slack || find_touch(pair.touches, Touch::CURVES, i, j) != pair.touches.end())
        pair.edges.push_back({i, j});
    }
  }
}

// Whether the sphere about one is apart from the other. They then sleep until they may have closed the gap.
bool are_apart(SolidPair &pair, const Solid &a, const Solid &b)
{
  constexpr double SURELY = 0.99;
  const double gap = std::max(b.shape.nearest(b.in_body(a.centre - b.centre)).distance - a.shape.bound(),
                              a.shape.nearest(a.in_body(b.centre - a.centre)).distance - b.shape.bound());
  pair.asleep = SURELY * gap;
  return gap > 0.0;
}

}    // namespace

void touch_with_curves(const TouchStep &step, SolidPair &pair, Solid &a, Solid &b, const TouchLaw &law)
{
  if (pair.touches.empty() && (pair.asleep > 0.0 || (is_with_mesh(a, b) ? is_far_from_mesh(pair, a, b) : are_apart(pair, a, b))))
    return;
  const double margin = margin_of(a, b);
  const bool stale = pair.known_for < 0.0;
  if (stale) look_up_sides(pair, a, b, margin);
  touch_sides(step, pair, false, a, b, law, margin, stale);
  touch_sides(step, pair, true, b, a, law, margin, stale);
  if (stale) look_up_curves(pair, a, b, margin);
  for (const NearFeatures &one : pair.edges) CurvePair(step, pair.touches, a, b, one.first, one.second, law).touch();
}

}    // namespace mdanim
