// SPDX-License-Identifier: GPL-2.0-only
// Points without a contact: where they are in the host, whether a contact begins, and when they are looked at again. What is
// known of a point from earlier looks tells at most that no contact begins. Whether one begins, and how, follows from places now
// and in the step before, so that a run that is resumed, and a part of a scene, has the same contacts.

#include "contact/contact_birth.h"
#include "contact/lattice_field.h"
#include "contact/look_batches.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

static constexpr double JUMP = 0.25;    // cells that X may jump between cells of a round host
static constexpr int MOST_GUESSES = 3;
static constexpr double WORTH = 0.1;    // cells that a point is put off by without a look, at least
static constexpr std::array<int, 3> NOWHERE = {-1, -1, -1}, OUTSIDE = {-2, -2, -2};    // of the outline, and not looked at

static Vec3 middle_of(const std::array<int, 3> &cell) { return {cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5}; }

// Finds the cell on the surface of the host whose middle is nearest to x. Where that is too far for a contact, it gives the
// verdict.
bool LatticeField::start(const Vec3 &x, const Moment &at, const ContactArrays &arrays, PointTrack &track,
                         std::array<int, 3> &cell, Verdict &verdict) const
{
  const ContactBody &body = *host->body;
  const double reach = NEAREST * body.spacing() + owner->body->radius();
  double away = NEVER;
  if (track.start[0] >= 0 && budget < track.trusted) cell = PointSearch(*host, at).outer_around(x, track.start, away);
  if (!(away < NEVER)) {
    const OuterCells::NearestCell found = host->outer->of(*host, arrays).nearest(x, at.place);
    cell = track.start = found.cell;
    away = cell[0] < 0 ? 0.5 * OuterCells::SEARCHED * body.spacing() : found.away;
    track.trusted = budget + 0.5 * (found.others - found.away);    // each of the two distances changes by this much at most
  }
  if (cell[0] >= 0 && away <= reach) return true;
  verdict = {};
  verdict.slack = std::max(0.0, away - reach);
  track.cell = NOWHERE, track.certain = NEVER;
  return false;
}

// Whether a guess from where the point was last tells that no contact begins, and the verdict that it gives.
bool LatticeField::is_surely_apart(std::size_t q, const Vec3 &x, const Moment &at, PointTrack &track, Verdict &verdict) const
{
  const SurfacePoint &point = surface_point(q);
  const ContactBody &body = *host->body;
  const double radius = owner->body->radius();
  const bool by_splines = is_smooth(body, point.kind);
  const PointSearch search(*host, at);
  const Vec3 shift = owner->shift_of(near[q], at.place);
  Spot<double> spot;
  Vec3 X;
  Facing facing;
  bool has_facing = false;
  double off = 1.0;
  for (int step = 0; step < MOST_GUESSES && off > SAME_PLACE && off < NEVER; ++step) {
    search.guess(track, x, budget, by_splines, spot, X, off);
    if (!(off < NEAR_PLACE)) continue;
    const Vec3 X_centre = X + spot.to_material(shift);
    if (const double slack = slack_of_far(body, point, radius, X, X_centre, spot, off); slack > 0.0) {
      verdict = {};
      verdict.slack = slack;
      return true;
    }
    if (!has_facing && !find_facing(q, at, facing)) return false;
    has_facing = true;
    verdict = judge(body, point, radius, X, X_centre, spot, facing, off);
    if (verdict.is_sure) return true;
  }
  return false;
}

Verdict LatticeField::lost()
{
  Verdict verdict;
  verdict.open = EVERY_SIDE;    // and no slack: searched again in the next step
  return verdict;
}

// The verdict on a point from places alone, and its X.
Verdict LatticeField::sight(std::size_t q, const Moment &at, const ContactArrays &arrays, PointTrack &track, Vec3 &X) const
{
  const SurfacePoint &point = surface_point(q);
  const ContactBody &body = *host->body;
  const Vec3 x = owner->place_of(near[q], at.place);
  Verdict verdict;
  Spot<double> spot;
  Facing facing;
  if (!start(x, at, arrays, track, track.cell, verdict)) return verdict;
  track.X = middle_of(track.cell);
  if (!PointSearch(*host, at).find(track, x, budget, is_smooth(body, point.kind), spot, X) || !find_facing(q, at, facing)) {
    track = {};
    return lost();
  }
  const Vec3 X_centre = X + spot.to_material(owner->shift_of(near[q], at.place));
  return judge(body, point, owner->body->radius(), X, X_centre, spot, facing, 0.0);
}

// Whether a point may be so near to the host that its place in it matters; if not, the verdict.
bool LatticeField::is_near(std::size_t q, const Moment &at, const ContactArrays &arrays, Verdict &verdict)
{
  PointTrack &track = known[q];
  const bool is_trusted = track.cell[0] >= 0 && (host->body->is_cuboid() || budget < track.trusted) && !host->is_crushed;
  if (is_trusted) return true;
  std::array<int, 3> cell;
  if (!start(owner->place_of(near[q], at.place), at, arrays, track, cell, verdict)) return false;
  if (track.cell[0] < 0) track.cell = cell, track.X = middle_of(cell), track.certain = AT_ONCE;
  return true;
}

// Puts a point off that is far from all of the host's surface, whatever is known of it.
bool LatticeField::is_beside_outline(std::size_t q, const ContactArrays &arrays)
{
  if (!host->outline.is_known()) return false;
  const double away = host->outline.away(owner->place_of(near[q], arrays.place())) - owner->body->radius();
  if (!(away > WORTH * host->body->spacing())) return false;
  wake.set(q, budget + away);
  if (known[q].cell[0] < 0) known[q].cell = OUTSIDE;
  return true;
}

// Until there may have been a motion that begins a contact. In another cell the depth may be different.
void LatticeField::put_off(std::size_t q, double slack)
{
  const double room = known[q].certain - budget;
  wake.set(q, budget + std::max(0.0, std::min(slack, std::max(room, slack - PRESSED * JUMP * host->body->spacing()))));
}

bool LatticeField::look_closely(std::size_t q, const ContactArrays &arrays, bool may_begin)
{
  PointTrack &track = known[q];
  const Moment now = arrays.now();
  Verdict verdict;
  Vec3 X;
  if (host->is_crushed || !is_surely_apart(q, owner->place_of(near[q], now.place), now, track, verdict))
    verdict = sight(q, now, arrays, track, X);
  if (!may_begin || verdict.side < 0) {
    put_off(q, verdict.slack);
    return false;
  }
  PointTrack before;
  Vec3 X_before;
  begin_contact(q, verdict, X, track.cell, sight(q, arrays.before(), arrays, before, X_before).open);
  return true;
}

bool LatticeField::look_at(std::size_t q, const ContactArrays &arrays, bool may_begin)
{
  ++looks;
  Verdict verdict;
  if (is_near(q, arrays.now(), arrays, verdict)) return look_closely(q, arrays, may_begin);
  put_off(q, verdict.slack);
  return false;
}

LookTask LatticeField::look_task(bool is_smooth, const ContactArrays &arrays) const
{
  const ContactBody &body = *host->body, &own = *owner->body;
  return {body.lattice(),
          arrays.place(),
          body.steepness(),
          ramps_of(body, is_smooth ? PointKind::SHARP : PointKind::FLAT),
          is_smooth,
          own.all_carriers(),
          own.is_line() ? nullptr : own.facings(),
          own.radius(),
          own.row(),
          own.layer(),
          own.spacing(),
          own.steepness(),
          own.frame().has_value()};
}

void LatticeField::take_look(std::size_t q, const LookedBlock &looked, int lane, const ContactArrays &arrays)
{
  PointTrack &track = known[q];
  PointTrack there = track;
  there.move_to({looked.cell[lane][0], looked.cell[lane][1], looked.cell[lane][2]}, looked.X[lane].value);
  if (looked.sure >> lane & 1 && PointSearch(*host, arrays.now()).confirm_cell(there, looked.x[lane].value, budget)) {
    track = there;
    put_off(q, looked.slack[lane]);
  } else {
    look_closely(q, arrays, true);
  }
}

// Several at once tell most of them apart from the host; others are looked at one by one.
void LatticeField::look_at_all(const std::vector<std::size_t> &points, const ContactArrays &arrays, LookBatches &batches)
{
  if (!arrays.kernels || host->is_crushed || host->body->has_covers() || owner->torn)
    return FieldOf::look_at_all(points, arrays, batches);
  for (const std::size_t q : points) {
    if (is_beside_outline(q, arrays)) continue;
    ++looks;
    Verdict verdict;
    if (!is_near(q, arrays.now(), arrays, verdict)) {
      put_off(q, verdict.slack);
      continue;
    }
    const PointTrack &track = known[q];
    batches.add(*this, q, is_smooth(*host->body, surface_point(q).kind),
                {near[q],
                 {track.cell[0], track.cell[1], track.cell[2]},
                 {track.X},
                 host->host_slots().data(),
                 owner->slot.data(),
                 &owner->rigid});
  }
}

}    // namespace mdanim
