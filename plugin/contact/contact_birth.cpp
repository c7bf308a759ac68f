// SPDX-License-Identifier: GPL-2.0-only
// The sides of a host that face a point, and its depth below them.

#include "contact/contact_birth.h"

#include "contact/material_map.h"
#include "contact/point_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mdanim {

static constexpr double LEAST_COSINE = 0.45;    // between the outward normals of the point and of a side that faces it, negated
static constexpr double DEEPEST_BIRTH = 0.5;    // cells
static constexpr double NEVER = std::numeric_limits<double>::infinity();

Ramps ramps_of(const ContactBody &host, PointKind kind)
{
  Ramps ramps;
  for (int d = 0; d < 3; ++d) {
    const double rise = kind == PointKind::FLAT ? std::min(1.0, 0.25 * host.count(d)) : 0.5;
    ramps.width[d] = rise / (1.0 - Ramp<double>::ROUND);
    ramps.from[d] = (kind == PointKind::FLAT ? 1.5 * rise : 0.0) - 0.5 * ramps.width[d];
  }
  return ramps;
}

double slack_of_far(const ContactBody &host, const SurfacePoint &point, double radius, const Vec3 &X, const Vec3 &X_centre,
                    const Spot<double> &spot, double off)
{
  const double least = PRESSED * (LEAST_COSINE + 1.0) + 1e-3 + off;    // cells; more than any normal can give
  const double h = host.spacing();
  if (!host.is_cuboid()) {
    const double apart = -(host.depth(0, X).value + radius) / h;
    return apart > least ? PRESSED * host.pressed(spot) * h * apart : 0.0;
  }
  const Lattice grid = host.lattice();
  const Ramps near_edges = ramps_of(host, point.kind);
  double slack = NEVER, beyond[3];    // way to the ramp about the nearer edge, along each axis
  for (int d = 0; d < 3; ++d)
    beyond[d] = near_edges.from[d] - std::min(component(X_centre, d), grid.cells[d] - component(X_centre, d));
  for (int s = 0; s < host.sides(); ++s) {
    const double depth = (host.depth(s, X).value + radius) / h;
    double of_side = -depth;    // distance from the side
    for (int d = 0; d < 3; ++d)
      if (d != s / 2) of_side = std::max(of_side, beyond[d]);
    if (of_side <= least) return 0.0;
    slack = std::min(slack, h * std::max(of_side, depth - DEEPEST_BIRTH));
  }
  return PRESSED * host.pressed(spot) * slack;
}

Verdict judge(const ContactBody &host, const SurfacePoint &point, double radius, const Vec3 &X, const Vec3 &X_centre,
              const Spot<double> &spot, const Facing &facing, double off)
{
  const double far = 1e-5 + off * off, turn = 1e-3 + 0.5 * off;    // errors of a depth and of a cosine of a guess, in cells
  const Lattice grid = host.lattice();
  const Ramps near_edges = ramps_of(host, point.kind);
  const double h = host.spacing(), press = PRESSED * host.pressed(spot), turning = std::min(h, facing.cell);
  int side = -1;
  bool is_shut = false, is_surely_shut = false, may_face = false;
  double best = NEVER, until = 0.0, slack = NEVER;
  Vec3 inward_of_side;
  Verdict verdict;
  for (int s = 0; s < host.sides(); ++s) {
    Depth<double> below = host.depth(s, X);
    below.value += radius;
    const double depth = below.value / h;    // in cells
    const Vec3 inward = spot.gradient(below.slope);
    const double cosine = facing.all ? 1.0 : dot(facing.normal, inward) / std::sqrt(dot(inward, inward));
    // Smallest change before the side can begin a contact, in cells: the largest of these three.
    double apart = -depth;
    const double turned = PRESSED * (LEAST_COSINE - cosine);
    if (host.is_cuboid())
      for (int d = 0; d < 3; ++d) {
        if (d == s / 2) continue;
        const double inside = std::min(component(X_centre, d), grid.cells[d] - component(X_centre, d));
        apart = std::max(apart, near_edges.from[d] - inside);
      }
    if (apart <= 0.0 || turned > apart) verdict.open |= static_cast<std::uint8_t>(1u << s);
    const double covered = host.covered(s, X);
    verdict.is_sure &= std::fabs(covered) > far + off;
    slack = std::min(slack, press * std::max({h * apart, turning * turned, h * (depth - DEEPEST_BIRTH)}));
    if (covered >= 0.0) continue;    // another held body is there, and no point reaches this side
    is_surely_shut |= turned < -turn && depth < -far;
    may_face |= turned < turn && apart < far && depth < DEEPEST_BIRTH + far;
    if (cosine < LEAST_COSINE) continue;
    if (depth <= 0.0) {
      is_shut = true;
      until = std::max(until, std::min(-press * depth * h, 0.5 * press * turning * (cosine - LEAST_COSINE)));
    } else if (depth / cosine < best) {
      best = depth / cosine, side = s, inward_of_side = inward;
      verdict.depth = below.value;
    }
  }
  verdict.is_sure &= is_surely_shut || !may_face;
  verdict.slack = is_shut ? std::max(slack, until) : slack;
  const bool is_deep = verdict.depth > DEEPEST_BIRTH * h;
  if (host.is_cuboid() && is_crushed(spot, host)) {
    verdict.is_crushed = true;
    verdict.open = EVERY_SIDE, verdict.slack = 0.0;    // X may be different in the next step
  }
  if (side >= 0 && is_smooth(host, point.kind)) {
    verdict.depth *= Flattened<double>(std::sqrt(dot(inward_of_side, inward_of_side))).value;
    if (verdict.is_crushed) side = -1;
  }
  const auto counts = [&] {
    Vec3 slope;
    return !host.is_cuboid() || part_that_counts<double>(near_edges, grid, X_centre, side / 2, slope) > 0.0;
  };
  if (!is_shut && side >= 0 && !is_deep && counts()) verdict.side = side;
  return verdict;
}

}    // namespace mdanim
