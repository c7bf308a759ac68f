// SPDX-License-Identifier: GPL-2.0-only
// Points without a contact: where they are in the host, whether a contact begins, and when they are looked at again.

#include "contact/contact_birth.h"
#include "contact/lattice_field.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

static constexpr double NEAREST = 2.2;    // in cells, from the middle of a cell on the surface; no contact beyond
static constexpr double JUMP = 0.25;      // cells that X may jump between cells of a round host
static constexpr int MOST_GUESSES = 3;
static constexpr double NEAR_PLACE = 0.1;    // cells that a guess may be away from the last one

bool LatticeField::look_at(std::size_t q, const ContactArrays &arrays, bool may_begin)
{
  ++looks;
  PointTrack &track = known[q];
  const SurfacePoint &point = surface_point(q);
  const Vec3 x = owner->place_of(near[q], arrays.place());
  const ContactBody &body = *host->body;
  const double h = body.spacing(), radius = owner->body->radius();
  const Placed at = {body, host->slot.data(), arrays.place()};
  const PointSearch search(*host, arrays);
  const bool by_splines = is_smooth(body, point.kind);
  const auto lost = [&] {
    track.cell = {-1, -1, -1};
    track.open = EVERY_SIDE;
    wake.set(q, budget);    // searched again in the next step
    return false;
  };
  if (track.cell[0] < 0) {
    const std::array<int, 3> cell = host->outer->of(*host, arrays).nearest(x, arrays.place());
    Spot<double> there;
    const Vec3 middle = {cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5};
    if (cell[0] >= 0 && !evaluate(at, trilinear(middle, cell, at.body), there)) return lost();
    const double away = cell[0] < 0 ? 0.5 * OuterCells::SEARCHED * h : std::sqrt(dot(x - there.x, x - there.x));
    const double nearest = NEAREST * h + radius;
    if (cell[0] < 0 || away > nearest) {
      track.open = 0;
      wake.set(q, budget + std::max(0.0, away - nearest));
      return false;
    }
    track.cell = cell, track.X = middle;
  }
  Spot<double> spot;
  Vec3 X, normal;
  const Vec3 shift = owner->shift_of(near[q], arrays.place());
  const std::uint8_t was_open = track.open;
  Verdict verdict;
  verdict.is_sure = false;
  bool has_normal = false;
  double off = 1.0;
  for (int step = 0; step < MOST_GUESSES && !verdict.is_sure && off > SAME_PLACE && off < NEVER; ++step) {
    search.guess(track, x, by_splines, spot, X, off);
    if (!(off < NEAR_PLACE)) continue;
    const Vec3 X_centre = X + spot.to_material(shift);
    if (const double slack = slack_of_far(body, point, radius, X, X_centre, off); slack > 0.0) {
      verdict = {};
      verdict.slack = slack;
      break;
    }
    if (!has_normal && !world_normal(point, arrays, normal)) return lost();
    has_normal = true;
    verdict = judge(body, point, radius, X, X_centre, spot, normal, off);
  }
  if (!verdict.is_sure) {
    if (!search.find(track, x, by_splines, spot, X) || !(has_normal || world_normal(point, arrays, normal))) return lost();
    verdict = judge(body, point, radius, X, X + spot.to_material(shift), spot, normal, 0.0);
  }
  track.open = verdict.open;
  if (!may_begin || verdict.side < 0) {
    // In another cell the depth may be different.
    const double slack = std::min(verdict.slack, std::max(track.room, verdict.slack - PRESSED * JUMP * h));
    wake.set(q, budget + std::max(0.0, slack));
    return false;
  }

  begin_contact(q, verdict, X, was_open);
  return true;
}

}    // namespace mdanim
