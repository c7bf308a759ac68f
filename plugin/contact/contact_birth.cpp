// SPDX-License-Identifier: GPL-2.0-only
// The sides of a host that face a point, and its depth below them.

#include "contact/contact_birth.h"

#include "contact/contact_judge.h"
#include "contact/material_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mdanim {

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
  const Lattice grid = host.lattice();
  const Ramps near_edges = ramps_of(host, point.kind);
  const double h = host.spacing();
  const Judge<double> task = {
      grid, near_edges, radius, X_centre, spot, facing.normal, std::min(h, facing.cell), PRESSED * host.pressed(spot),
      off,  facing.all};
  const auto depth = [&](int s) { return host.depth(s, X); };
  const auto covered = [&](int s) { return host.covered(s, X); };
  const Judged<double> judged =
      host.is_cuboid() ? judge_sides<true>(task, depth, covered) : judge_sides<false>(task, depth, covered);
  Verdict verdict;
  verdict.depth = judged.depth;
  verdict.open = static_cast<std::uint8_t>(judged.open);
  verdict.slack = judged.slack;
  verdict.is_sure = !(judged.is_unsure > 0.0);
  int side = static_cast<int>(judged.side);
  const bool is_deep = verdict.depth > DEEPEST_BIRTH * h;
  if (host.is_cuboid() && is_crushed(spot, host)) {
    verdict.is_crushed = true;
    verdict.open = EVERY_SIDE, verdict.slack = 0.0;    // X may be different in the next step
  }
  if (side >= 0 && is_smooth(host, point.kind)) {
    verdict.depth *= Flattened<double>(std::sqrt(dot(judged.inward, judged.inward))).value;
    if (verdict.is_crushed) side = -1;
  }
  const auto counts = [&] {
    Vec3 slope;
    return !host.is_cuboid() || part_that_counts<double>(near_edges, grid, X_centre, side / 2, slope) > 0.0;
  };
  if (!(judged.is_shut > 0.0) && side >= 0 && !is_deep && counts()) verdict.side = side;
  return verdict;
}

}    // namespace mdanim
