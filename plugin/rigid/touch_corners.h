// SPDX-License-Identifier: GPL-2.0-only
// Corners of a polyhedron in a host. A host has sides; below each there is a depth, and a part that counts near its edges.

#pragma once

#include "rigid/pair.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mdanim {

// A polyhedron as host, in its own frame.
class PolyhedronHost {
 public:
  PolyhedronHost(const Polyhedron &shape, double ramp) : shape(shape), ramp(ramp) {}

  int sides() const { return static_cast<int>(shape.faces().size()); }
  template <class Visit> void each_flat_side(const Visit &visit) const
  {
    for (int side = 0; side < sides(); ++side)
      if (is_open(side)) visit(side);
  }
  bool is_open(int side) const { return !shape.faces()[side].covered; }
  Vec3 normal(int side, const Vec3 &) const { return shape.faces()[side].normal; }
  double depth(int side, const Vec3 &x) const { return shape.faces()[side].at - dot(shape.faces()[side].normal, x); }
  double outside(const Vec3 &x) const { return shape.outside(x); }
  // Part of a contact at x below a side: it fades over the ramp at sharp edges. Of an outline of many edges the two nearest ones
  // count, one as much as the other where x is as near to both.
  double part(int side, const Vec3 &x, Vec3 &slope) const
  {
    constexpr double ROUND = 0.1;    // over the ramp: how far the corner between both is rounded
    const std::vector<Polyhedron::Bound> &bounds = shape.faces()[side].bounds;
    double part = 1.0;
    slope = Vec3();
    for (auto bound = bounds.begin(); bound != bounds.end();) {
      const int outline = bound->outline;
      double inside = HUGE_VAL, next = HUGE_VAL;
      Vec3 outward, outward_of_next;
      for (; bound != bounds.end() && bound->outline == outline; ++bound) {
        const double from = bound->at - dot(bound->outward, x);
        if (from < inside)
          next = inside, outward_of_next = outward, inside = from, outward = bound->outward;
        else if (from < next)
          next = from, outward_of_next = bound->outward;
      }
      if (const double near = 1.0 - (next - inside) / (ROUND * ramp); near > 0.0) {
        inside -= 0.25 * ROUND * ramp * near * near;
        outward += (0.5 * near) * (outward_of_next - outward);
      }
      double steep;
      const double one = smooth_step(inside, ramp, steep);
      slope = one * slope - (part * steep) * outward;
      part *= one;
    }
    return part;
  }
  // The side below which x is least deep, among this one and those beyond its blunt edges.
  int shallowest(int side, const Vec3 &x) const
  {
    for (int moves = 0; moves < sides(); ++moves) {
      int least = side;
      for (const int other : shape.faces()[side].next)
        if (depth(other, x) < depth(least, x)) least = other;
      if (least == side) break;
      side = least;
    }
    return side;
  }

 private:
  const Polyhedron &shape;
  double ramp;
};

// Cosine between an edge of a corner and the normal of a side below which the corner cannot be: the edge leads into the host.
constexpr double LEADS_IN = -0.45;
constexpr double DEEPEST_BIRTH = 0.5, SHALLOW = 0.03;    // over the thinnest part of the host
constexpr double SURELY = 0.9;                           // of a way that leads nowhere near
constexpr double LITTLE = 0.1;                           // part with which a contact begins that comes over a ramp
constexpr double A_STEP = 1.01;                          // the last step, and a little for rounding

// The side of a host below which a corner is, with the depth; -1 where it is below none: it has to be below each side that
// faces it, and belongs to the one below which it is least deep.
template <class Host, class Turn>
int side_of_birth(const Host &host, const Polyhedron::Corner &corner, const Turn &in_owner, const Vec3 &x, double deepest,
                  double &depth)
{
  int found = -1;
  depth = HUGE_VAL;
  for (int side = 0; side < host.sides(); ++side) {
    if (!host.is_open(side)) continue;
    const double d = host.depth(side, x);
    if (d > 0.0 && d >= depth) continue;
    const Vec3 n = in_owner(host.normal(side, x));
    const bool leads_in =
        std::any_of(corner.ways.begin(), corner.ways.end(), [&](const Vec3 &way) { return dot(way, n) < LEADS_IN; });
    if (leads_in) continue;
    if (d <= 0.0) return -1;
    depth = d, found = side;
  }
  if (found < 0 || depth > deepest) return -1;
  // Beyond a blunt edge there may be a side through which the corner leads in: contacts go on below it.
  found = host.shallowest(found, x);
  depth = host.depth(found, x);
  return depth > 0.0 ? found : -1;
}

// Whether it belongs to this side.
template <class Host, class Turn>
bool is_born_below(const Host &host, int side, const Polyhedron::Corner &corner, const Turn &in_owner, const Vec3 &x,
                   double deepest)
{
  double unused;
  return side_of_birth(host, corner, in_owner, x, deepest, unused) == side;
}

// Begins the contact of corner q of `a`, which is at x in the frame of `b`, this deep below a side.
template <class Host>
Touch born_below(const TouchStep &step, Touch::TouchKind kind, int q, int side, const Vec3 &x, double depth, const Solid &a,
                 const Solid &b, const Host &host, const TouchLaw &law)
{
  const Vec3 place = b.place(x), n = b.in_space(host.normal(side, x));
  Touch touch = step.born(kind, law, a, &b, place, n);
  touch.first = q;
  touch.side = side;
  touch.anchor = x;
  const Vec3 relative = TouchStep::relative_velocity(a, &b, place);
  const Vec3 before = x - (A_STEP * step.time_step()) * b.in_body(relative);
  Vec3 unused;
  const bool came = !step.is_first() && (host.depth(side, before) <= 0.0 ||
                                         (depth < SHALLOW * b.shape.thin() && host.part(side, before, unused) <= 0.0));
  if (came)
    TouchStep::came_from(touch, depth + step.time_step() * dot(relative, n));
  else
    TouchStep::overlaps(touch, depth);
  return touch;
}

// The force of the contact of a corner that is at x now, which may have ended.
template <class Host>
void press_corner(const TouchStep &step, Touch &touch, const Vec3 &x, Solid &a, Solid &b, const Host &host, const TouchLaw &law)
{
  const double depth = host.depth(touch.side, x);
  const Vec3 n = b.in_space(host.normal(touch.side, x));
  Vec3 slope;
  const double part = host.part(touch.side, x, slope);
  if (depth <= 0.0 || part <= 0.0)
    step.part(touch, a, &b, {b.place(x), n, depth, part});
  else
    step.press(touch, law, a, &b, x, depth, part, slope, n);
}

// A box around what may touch `other`, in the frame of `one`.
inline Box box_around(const Solid &one, const Solid &other, double more)
{
  const Vec3 middle = one.in_body(other.centre - one.centre);
  Box box;
  box.include(&middle.x);
  return box.grown(other.shape.bound() + more);
}

// Calls visit(q) for corners of `one` that may be near `other`, among them all that touch it. `touches`: contacts of this kind.
template <class Visit>
void each_corner_near(const Solid &one, const Solid &other, double more, const std::vector<Touch> &touches, Touch::TouchKind kind,
                      const Visit &visit)
{
  const std::vector<Polyhedron::Corner> &corners = one.shape.corners();
  std::vector<int> numbers(corners.size());
  if (one.shape.kind() == SolidShape::MESH) {
    numbers = one.shape.mesh().corners_near(box_around(one, other, more));
    for (const Touch &touch : touches)
      if (touch.kind == kind) numbers.push_back(touch.first);
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  } else {
    std::iota(numbers.begin(), numbers.end(), 0);
  }
  for (const int q : numbers)
    if (!corners[q].covered) visit(q);
}

// Corners of `a` in `host`, the convex shape of `b`; those that may touch are looked up anew where `stale`.
template <class Host>
void touch_corners(const TouchStep &step, SolidPair &pair, bool of_other, Solid &a, Solid &b, const Host &host,
                   const TouchLaw &law, double ramp, double margin, bool stale)
{
  const Touch::TouchKind kind = of_other ? Touch::CORNER_OF_OTHER : Touch::CORNER;
  std::vector<Touch> &touches = pair.touches;
  std::vector<NearFeatures> &near = pair.corners[of_other];
  if (!stale && near.empty()) return;
  const std::vector<Polyhedron::Corner> &corners = a.shape.corners();
  const Vec3 between = b.in_body(a.centre - b.centre);
  const auto in_host = [&](const Vec3 &own) { return between + b.in_body(a.in_space(own)); };
  if (stale) {
    near.clear();
    each_corner_near(a, b, ramp + margin, touches, kind, [&](int q) {
      if (host.outside(in_host(corners[q].at)) < ramp + margin || find_touch(touches, kind, q) != touches.end())
        near.push_back({q});
    });
  }
  for (NearFeatures &one : near) {
    if (pair.known_for > one.until) continue;
    const int q = one.first;
    const Vec3 x = in_host(corners[q].at);
    auto found = find_touch(touches, kind, q);
    const bool is_known = found != touches.end();
    if (is_known) {
      found->side = host.shallowest(found->side, x);
    } else if (const double way = host.outside(x) - ramp; way >= 0.0) {
      one.until = pair.known_for - SURELY * way;
      continue;
    }
    // A contact that began below its side, and so without a force, gives way where the corner comes below a nearer side.
    if (!is_known || (found->memory.offset > 0.0 && !step.is_first())) {
      const auto in_owner = [&](const Vec3 &n) { return a.in_body(b.in_space(n)); };
      const double deepest = is_known ? host.depth(found->side, x) : DEEPEST_BIRTH * b.shape.thin();
      double depth;
      Vec3 unused;
      const int side = side_of_birth(host, corners[q], in_owner, x, deepest, depth);
      const bool begins = side >= 0 && host.part(side, x, unused) > 0.0 && !(is_known && side == found->side);
      if (!is_known && !begins) continue;
      if (is_known && begins) {
        step.let_go(*found, deepest, host.part(found->side, x, unused));
        touches.erase(found);
      }
      if (begins) {
        touches.push_back(born_below(step, kind, q, side, x, depth, a, b, host, law));
        found = touches.end() - 1;
      }
    }
    press_corner(step, *found, x, a, b, host, law);
  }
}

}    // namespace mdanim
