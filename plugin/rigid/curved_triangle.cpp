// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/curved_triangle.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

static constexpr double FLAT = 1e-7;       // bulge over the longest edge below which a triangle is flat
static constexpr int MOST_STEPS = 30;      // of Newton's method
static constexpr double ENOUGH = 1e-14;    // step of a place that ends it
static constexpr double OUTSIDE = 0.5;     // how far it may leave the triangle

// Control points at a third and two thirds of each edge lie in the tangent planes of its ends; the middle one is that of a
// quadratic patch with these.
CurvedTriangle::CurvedTriangle(const Vec3 (&corner)[3], const Vec3 (&normal)[3], const bool (&is_straight)[3])
{
  Vec3 third[3][2], sum;    // of edge k: next to its first corner, and to its second
  double longest = 0.0;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    its_corner[k] = corner[k];
    const Vec3 way = corner[next] - corner[k];
    longest = std::max(longest, length(way));
    const double rises = is_straight[k] ? 0.0 : dot(way, normal[k]), falls = is_straight[k] ? 0.0 : dot(way, normal[next]);
    third[k][0] = (1.0 / 3.0) * (2.0 * corner[k] + corner[next] - rises * normal[k]);
    third[k][1] = (1.0 / 3.0) * (2.0 * corner[next] + corner[k] + falls * normal[next]);
    sum += third[k][0] + third[k][1];
    its_bulge = std::max({its_bulge, std::fabs(rises) / 3.0, std::fabs(falls) / 3.0});
  }
  const Vec3 &a = corner[0], &b = corner[1], &c = corner[2];
  by_u = b - a;
  by_v = c - a;
  flat = !(its_bulge > FLAT * longest);
  if (flat) return;
  const Vec3 middle = (1.0 / 4.0) * sum - (1.0 / 6.0) * ((a + b) + c);
  its_bulge *= 1.5;    // the middle control point may be farther than those of edges by half
  const Vec3 &d = third[0][0], &e = third[0][1], &f = third[1][0], &g = third[1][1], &h = third[2][0], &i = third[2][1];
  by_u = 3.0 * (d - a);
  by_v = 3.0 * (i - a);
  by_uu = 3.0 * (a - 2.0 * d + e);
  by_vv = 3.0 * (a - 2.0 * i + h);
  by_uv = 6.0 * (a - d - i + middle);
  by_uuu = b - a + 3.0 * (d - e);
  by_vvv = c - a + 3.0 * (i - h);
  by_uuv = 3.0 * (2.0 * d - a - e + f + i - 2.0 * middle);
  by_uvv = 3.0 * (2.0 * i - a - h + g + d - 2.0 * middle);
}

CurvedTriangle::Jet CurvedTriangle::jet(const Place &p) const
{
  const double u = p.u, v = p.v;
  Jet found;
  found.at = its_corner[0] + u * (by_u + u * (by_uu + u * by_uuu)) + v * (by_v + v * (by_vv + v * by_vvv)) +
             (u * v) * (by_uv + u * by_uuv + v * by_uvv);
  found.u = by_u + u * (2.0 * by_uu + (3.0 * u) * by_uuu) + v * (by_uv + (2.0 * u) * by_uuv + v * by_uvv);
  found.v = by_v + v * (2.0 * by_vv + (3.0 * v) * by_vvv) + u * (by_uv + u * by_uuv + (2.0 * v) * by_uvv);
  found.uu = 2.0 * by_uu + (6.0 * u) * by_uuu + (2.0 * v) * by_uuv;
  found.vv = 2.0 * by_vv + (6.0 * v) * by_vvv + (2.0 * u) * by_uvv;
  found.uv = by_uv + (2.0 * u) * by_uuv + (2.0 * v) * by_uvv;
  return found;
}

// C. Ericson, "Real-time collision detection", 2005, section 5.1.5.
TrianglePoint CurvedTriangle::closest_of_flat(const Vec3 &x, Place &place) const
{
  const Vec3 &a = its_corner[0], &b = its_corner[1], &c = its_corner[2], ab = b - a, ac = c - a;
  const auto found = [&](double u, double v, TrianglePoint::Feature feature, int number) {
    place = {u, v};
    TrianglePoint point{a + u * ab + v * ac, 0.0, feature, number};
    if (feature == TrianglePoint::CORNER) point.at = its_corner[number];
    point.distance = length(x - point.at);
    return point;
  };
  const Vec3 from_a = x - a, from_b = x - b, from_c = x - c;
  const double d1 = dot(ab, from_a), d2 = dot(ac, from_a), d3 = dot(ab, from_b), d4 = dot(ac, from_b), d5 = dot(ab, from_c),
               d6 = dot(ac, from_c);
  if (d1 <= 0.0 && d2 <= 0.0) return found(0.0, 0.0, TrianglePoint::CORNER, 0);
  if (d3 >= 0.0 && d4 <= d3) return found(1.0, 0.0, TrianglePoint::CORNER, 1);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return found(d1 / (d1 - d3), 0.0, TrianglePoint::EDGE, 0);
  if (d6 >= 0.0 && d5 <= d6) return found(0.0, 1.0, TrianglePoint::CORNER, 2);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return found(0.0, d2 / (d2 - d6), TrianglePoint::EDGE, 2);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return found(1.0 - along, along, TrianglePoint::EDGE, 1);
  }
  const double over = 1.0 / (va + vb + vc);
  return found(vb * over, vc * over, TrianglePoint::INSIDE, 0);
}

// Newton's method for the least distance; where the second derivatives have no minimum, by those of the tangent plane. Whether it
// ends inside.
bool CurvedTriangle::find_inside(const Vec3 &x, Place &place) const
{
  for (int n = 0; n < MOST_STEPS; ++n) {
    const Jet s = jet(place);
    const Vec3 from = s.at - x;
    const double gu = dot(s.u, from), gv = dot(s.v, from), pu = dot(s.u, s.u), pv = dot(s.v, s.v), pm = dot(s.u, s.v);
    double hu = pu + dot(s.uu, from), hv = pv + dot(s.vv, from), hm = pm + dot(s.uv, from);
    if (!(hu > 0.0 && hu * hv - hm * hm > 1e-3 * (pu * pv - pm * pm))) hu = pu, hv = pv, hm = pm;
    const double over = 1.0 / (hu * hv - hm * hm), du = over * (hm * gv - hv * gu), dv = over * (hm * gu - hu * gv);
    place.u += du;
    place.v += dv;
    if (!(std::min({place.u, place.v, 1.0 - place.u - place.v}) > -OUTSIDE)) return false;
    if (std::fabs(du) + std::fabs(dv) < ENOUGH) break;
  }
  return place.u > 0.0 && place.v > 0.0 && place.u + place.v < 1.0;
}

TrianglePoint CurvedTriangle::closest_of_edge(int edge, const Vec3 &x) const
{
  const auto place = [edge](double t) { return edge == 0 ? Place{t, 0.0} : edge == 1 ? Place{1.0 - t, t} : Place{0.0, 1.0 - t}; };
  const Vec3 &a = its_corner[edge], &b = its_corner[(edge + 1) % 3], way = b - a;
  double t = std::min(std::max(dot(way, x - a) / dot(way, way), 0.0), 1.0);
  for (int n = 0; n < MOST_STEPS; ++n) {
    const Jet s = jet(place(t));
    const Vec3 from = s.at - x,
               along = edge == 0   ? s.u
                       : edge == 1 ? s.v - s.u
                                   : -1.0 * s.v,
               bends = edge == 0   ? s.uu
                       : edge == 1 ? s.uu + s.vv - 2.0 * s.uv
                                   : s.vv;
    const double slope = dot(along, from), least = dot(along, along), full = least + dot(bends, from);
    const double now = std::min(std::max(t - slope / (full > 1e-3 * least ? full : least), 0.0), 1.0), moved = now - t;
    t = now;
    if (std::fabs(moved) < ENOUGH) break;
  }
  TrianglePoint found{jet(place(t)).at, 0.0, TrianglePoint::EDGE, edge};
  if (t <= 0.0 || t >= 1.0) {
    found.feature = TrianglePoint::CORNER;
    found.number = t <= 0.0 ? edge : (edge + 1) % 3;
    found.at = its_corner[found.number];
  }
  found.distance = length(x - found.at);
  return found;
}

TrianglePoint CurvedTriangle::closest(const Vec3 &x) const
{
  Place place{};
  TrianglePoint found = closest_of_flat(x, place);
  if (flat) return found;
  if (find_inside(x, place)) {
    found = {jet(place).at, 0.0, TrianglePoint::INSIDE, 0};
    found.distance = length(x - found.at);
    return found;
  }
  found = closest_of_edge(0, x);
  for (int edge = 1; edge < 3; ++edge)
    if (const TrianglePoint other = closest_of_edge(edge, x); other.distance < found.distance) found = other;
  return found;
}

}    // namespace mdanim
