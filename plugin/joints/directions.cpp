// SPDX-License-Identifier: GPL-2.0-only

#include "joints/directions.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace mdanim {

static constexpr double OFF = 1e-6;    // of its size, that a patch may lack of a place or direction

static const char *shape_of(int dimensions) { return dimensions == 0 ? "one point" : dimensions == 1 ? "a line" : "a plane"; }

void expect_place(const Patch &patch, const Vec3 &d)
{
  const double off = length(d - patch.within(d));
  if (off > OFF * (patch.radius() + length(d)) + Patch::ROUNDING * length(patch.centre()))
    throw std::runtime_error("the particles that it holds on to stand in " + std::string(shape_of(patch.dimensions())) +
                             ", and its place is off by " + LineWords::short_form(off) +
                             "; take a place there, or a larger 'patch'");
}

// The direction across the axis of a hinge that is the hardest to turn, or the one that a flat patch has.
static Vec3 across_of(const Vec3 &n, const Patch &a, const Patch &b)
{
  const bool x_is_least = std::fabs(n.x) <= std::fabs(n.y) && std::fabs(n.x) <= std::fabs(n.z);
  const Vec3 other = x_is_least                         ? Vec3{1.0, 0.0, 0.0}
                     : std::fabs(n.y) <= std::fabs(n.z) ? Vec3{0.0, 1.0, 0.0}
                                                        : Vec3{0.0, 0.0, 1.0};
  const Vec3 u = unit(cross(n, other)), v = cross(n, u);
  for (const Patch *patch : {&a, &b})
    if (patch->dimensions() == 2) {
      const Vec3 along = cross(cross(patch->within_span(0), patch->within_span(1)), n);
      if (length(along) > 0.5) return unit(along);
    }
  double uu = 0.0, vv = 0.0, uv = 0.0;    // of the sum of the mobilities of both patches
  for (const Patch *patch : {&a, &b}) {
    if (patch->is_world()) continue;
    uu += patch->mobility_of_direction(u), vv += patch->mobility_of_direction(v);
    uv += dot(u, patch->velocity_of_direction(v));
  }
  const double half = 0.5 * (uu - vv), least = 0.5 * (uu + vv) - std::sqrt(half * half + uv * uv);
  const Vec3 found = std::fabs(uu - least) > std::fabs(vv - least) ? -uv * u + (uu - least) * v : (vv - least) * u - uv * v;
  return length(found) > 1e-9 * (uu + vv) ? unit(found) : u;
}

// The directions that are held are those that both patches have.
JointDirections directions_of(const JointWords &words, const Patch &a, const Patch &b)
{
  JointDirections found;
  const auto has = [](const Patch &patch, const Vec3 &e) { return length(e - patch.within(e)) <= OFF; };
  const auto both_have = [&](const Vec3 &e) { return has(a, e) && has(b, e); };
  const auto need = [&](bool met, const char *lacks) {
    if (!met)
      throw std::runtime_error(std::string("the particles that it holds on to have no ") + lacks +
                               ": they stand in a plane, on a line or in a point; take a larger 'patch', or a ball");
  };
  const Patch &flat = a.dimensions() <= b.dimensions() ? a : b;
  switch (words.kind) {
    case JointKind::SPRING:
    case JointKind::BALL:
      break;
    case JointKind::HINGE:
      found.held[0] = words.axis;
      found.many = 1;
      found.across = across_of(words.axis, a, b);
      need(both_have(words.axis) && both_have(found.across), "axis to turn about");
      break;
    case JointKind::WELD:
    case JointKind::SLIDER:
      found.many = flat.dimensions();
      for (int k = 0; k < found.many; ++k) found.held[k] = flat.within_span(k);
      need(found.many > 0 && both_have(found.held[0]) && both_have(found.held[1]), "direction that both bodies have");
      need(words.kind == JointKind::WELD || has(b, words.axis), "axis to slide along");
  }
  return found;
}

}    // namespace mdanim
