// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/curve.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mdanim {

static constexpr double PARALLEL = 1e-4;    // square of the sine below which two lines have no crossing

CurvePoint::CurvePoint(const Curve &line, double s)
    : at(line.middle + s * line.along), tangent(line.along), radius(line.radius_at(s)), place(line.on_surface(s)),
      across{line.across[0], line.across[1]}
{
}

CurvePoint::CurvePoint(const Curve &circle, const Vec3 &e)
    : at(circle.middle + circle.size * e), tangent(cross(circle.along, e)), radius(circle.thick),
      across{-1.0 * e, circle.into_side(e)}
{
}

// The foot is p_k = a_k^2 x_k / (a_k^2 + t) with sum (p_k/a_k)^2 = 1: Newton from below, where the sum is convex and falls.
EllipsoidFoot::EllipsoidFoot(const double (&x)[3], const double (&a)[3])
{
  constexpr double OFF_POLE = 1e-12;
  constexpr int MOST_STEPS = 50;
  double t = -HUGE_VAL;
  for (int k = 0; k < 3; ++k) t = std::max(t, a[k] * ((OFF_POLE - 1.0) * a[k] + std::fabs(x[k])));
  for (int n = 0; n < MOST_STEPS; ++n) {
    double value = -1.0, slope = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double share = a[k] * x[k] / (a[k] * a[k] + t);
      value += share * share;
      slope -= 2.0 * share * share / (a[k] * a[k] + t);
    }
    if (!(value > 0.0) || !(slope < 0.0)) break;
    const double next = t - value / slope;
    if (next == t) break;
    t = next;
  }
  for (int k = 0; k < 3; ++k) {
    const double over = x[k] / (a[k] * a[k] + t);
    at[k] = a[k] * a[k] * over;
    normal[k] = over;
  }
}

static CurvePoint closest_on_egg(const Curve &egg, const Vec3 &from)
{
  const Vec3 axes[3] = {egg.any, cross(egg.along, egg.any), egg.along};
  const EllipsoidFoot foot({dot(from, axes[0]), dot(from, axes[1]), dot(from, axes[2])}, {egg.half.x, egg.half.y, egg.half.z});
  CurvePoint point;
  point.at = egg.middle + (foot.at[0] * axes[0] + foot.at[1] * axes[1] + foot.at[2] * axes[2]);
  return point;
}

// The surface about a ball that moves along a line, with a radius that falls by `taper`, is closest to p where the way along it
// is -taper times the distance.
CurvePoint closest(const Curve &curve, const Vec3 &p)
{
  const Vec3 from = p - curve.middle;
  if (curve.is_egg) return closest_on_egg(curve, from);
  const double s = dot(from, curve.along);
  const Vec3 across = from - s * curve.along;
  const double out = length(across);
  if (curve.is_circle) return {curve, out > 0.0 ? (1.0 / out) * across : curve.any};
  return {curve, s - curve.taper * out / std::sqrt(1.0 - curve.taper * curve.taper)};
}

// --- two lines ---

// Least of |p + s u - q - r w| - both radii: with L the distance there and D that of the lines, L^2 = D^2 + Q, Q = L^2 x a form
// of both tapers.
static std::vector<CurveMeeting> crossing(const Curve &a, const Curve &b)
{
  const double cosine = dot(a.along, b.along), square = 1.0 - cosine * cosine;
  if (square < PARALLEL) return {};
  const Vec3 between = a.middle - b.middle;
  const double along_a = dot(a.along, between), along_b = dot(b.along, between);
  double s = (cosine * along_b - along_a) / square, r = (along_b - cosine * along_a) / square;
  const double form = (a.taper * a.taper + 2.0 * cosine * a.taper * b.taper + b.taper * b.taper) / square;
  if (form >= 1.0) return {};    // one is steeper than the other: nowhere
  if (form > 0.0) {
    const double distance = length(between + s * a.along - r * b.along) / std::sqrt(1.0 - form);
    s -= distance * (a.taper + cosine * b.taper) / square;
    r -= distance * (b.taper + cosine * a.taper) / square;
  }
  return {{{a, s}, {b, r}}};
}

// --- circles ---

namespace {

constexpr int SAMPLES = 12;    // around a circle, to find all minima
constexpr double HALF_ROOT_3 = 0.86602540378443864676;
constexpr double COSINE[SAMPLES] = {1.0,  HALF_ROOT_3,  0.5,  0.0, -0.5, -HALF_ROOT_3,
                                    -1.0, -HALF_ROOT_3, -0.5, 0.0, 0.5,  HALF_ROOT_3};
constexpr int MOST_STEPS = 40;
constexpr double ROUNDING = 1e-16;

// The distance of a circle's points from another curve. A point near e is e + t (axis x e), made 1 long.
class AroundCircle {
 public:
  AroundCircle(const Curve &circle, const Curve &other) : circle(circle), other(other) {}

  // Half of the derivative of its square around the circle.
  double slope(const Vec3 &e) const
  {
    const Vec3 p = circle.middle + circle.size * e;
    return dot(p - closest(other, p).at, cross(circle.along, e));
  }
  Vec3 turned(const Vec3 &e, double t) const { return unit(e + t * cross(circle.along, e)); }
  CurveMeeting meeting(const Vec3 &e) const
  {
    const CurvePoint point(circle, e);
    return {point, closest(other, point.at)};
  }
  // The minimum between e, where the slope is `from` < 0, and e + t, where it is `to` >= 0: the Illinois form of false position.
  Vec3 minimum(const Vec3 &e, double from, double t, double to) const
  {
    double low = 0.0, high = t, at = t;
    const double little = ROUNDING * circle.size * circle.size;
    for (int n = 0, last = 0; n < MOST_STEPS && to > little; ++n) {
      at = (low * to - high * from) / (to - from);
      if (at <= low || at >= high) break;
      const double value = slope(turned(e, at));
      if (std::fabs(value) < little) break;
      if (value < 0.0) {
        low = at, from = value;
        if (last < 0) to *= 0.5;
        last = -1;
      } else {
        high = at, to = value;
        if (last > 0) from *= 0.5;
        last = 1;
      }
      if (high - low < 1e-15) break;
    }
    return turned(e, at);
  }
  // The minimum near e, by the secant.
  Vec3 minimum_near(const Vec3 &e) const
  {
    double before = 0.0, at = 1e-6, value = slope(e);
    for (int n = 0; n < MOST_STEPS && std::fabs(at - before) > 1e-15; ++n) {
      const double now = slope(turned(e, at)), steep = (now - value) / (at - before);
      if (!(steep > 0.0)) break;
      before = at, value = now;
      at -= std::min(std::max(now / steep, -1e-3), 1e-3);
    }
    return turned(e, at);
  }
  std::vector<CurveMeeting> all() const
  {
    constexpr double STEP = 0.57735026918962576451;    // tangent of 30 degrees
    const Vec3 side = cross(circle.along, circle.any);
    Vec3 e[SAMPLES];
    double slopes[SAMPLES];
    for (int n = 0; n < SAMPLES; ++n) {
      e[n] = COSINE[n] * circle.any + COSINE[(n + 9) % SAMPLES] * side;
      slopes[n] = slope(e[n]);
    }
    std::vector<CurveMeeting> found;
    for (int n = 0; n < SAMPLES; ++n)
      if (const double next = slopes[(n + 1) % SAMPLES]; slopes[n] < 0.0 && next >= 0.0)
        found.push_back(meeting(minimum(e[n], slopes[n], STEP, next)));
    return found;
  }

 private:
  const Curve &circle, &other;
};

}    // namespace

static CurveMeeting swapped(CurveMeeting found)
{
  std::swap(found.a, found.b);
  return found;
}

std::vector<CurveMeeting> meetings(const Curve &a, const Curve &b)
{
  if (a.is_circle) return AroundCircle(a, b).all();
  if (!b.is_circle) return crossing(a, b);
  std::vector<CurveMeeting> found = AroundCircle(b, a).all();
  for (CurveMeeting &one : found) one = swapped(one);
  return found;
}

CurveMeeting meeting_near(const Curve &a, const Curve &b, const CurveMeeting &known)
{
  const auto on = [](const Curve &circle, const CurvePoint &point) {
    const Vec3 out = point.at - circle.middle;
    return unit(out - dot(out, circle.along) * circle.along);
  };
  if (a.is_circle) {
    const AroundCircle around(a, b);
    return around.meeting(around.minimum_near(on(a, known.a)));
  }
  if (b.is_circle) {
    const AroundCircle around(b, a);
    return swapped(around.meeting(around.minimum_near(on(b, known.b))));
  }
  const std::vector<CurveMeeting> found = crossing(a, b);
  return found.empty() ? known : found[0];
}

// The middle of a circle, or the closest points of two segments.
double least_gap(const Curve &a, const Curve &b)
{
  const double reach_a = a.is_circle ? 0.0 : a.size, reach_b = b.is_circle ? 0.0 : b.size;
  const Vec3 u = reach_a > 0.0 ? a.along : Vec3{}, w = reach_b > 0.0 ? b.along : Vec3{}, between = a.middle - b.middle;
  const double cosine = dot(u, w), square = 1.0 - cosine * cosine, on_a = dot(u, between), on_b = dot(w, between);
  double least = HUGE_VAL;
  const auto try_at = [&](double s, double r) { least = std::min(least, length(between + s * u - r * w)); };
  const auto within = [](double value, double reach) { return std::min(std::max(value, -reach), reach); };
  if (square > PARALLEL) {
    const double s = (cosine * on_b - on_a) / square, r = (on_b - cosine * on_a) / square;
    if (std::fabs(s) <= reach_a && std::fabs(r) <= reach_b) try_at(s, r);
  }
  for (const double sign : {-1.0, 1.0}) {
    try_at(sign * reach_a, within(on_b + sign * reach_a * cosine, reach_b));
    try_at(within(sign * reach_b * cosine - on_a, reach_a), sign * reach_b);
  }
  // A circle is within its plane.
  const auto from_plane = [](const Curve &circle, const Curve &other) {
    const double level = dot(circle.along, other.along),
                 reach = other.size * (other.is_circle ? std::sqrt(std::max(0.0, 1.0 - level * level)) : std::fabs(level));
    return std::fabs(dot(circle.along, other.middle - circle.middle)) - reach;
  };
  double apart = 0.0;
  if (a.is_circle) apart = std::max(apart, from_plane(a, b));
  if (b.is_circle) apart = std::max(apart, from_plane(b, a));
  const double round = (a.is_circle ? a.size : 0.0) + (b.is_circle ? b.size : 0.0);
  return std::max(least - round, apart) - a.reach - b.reach;
}

}    // namespace mdanim
