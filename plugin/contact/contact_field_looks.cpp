// SPDX-License-Identifier: GPL-2.0-only
// Points without a contact: where they are in the host, whether a contact begins, and when they are looked at again.

#include "contact/contact_field.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

static constexpr double LEAST_COSINE = 0.45;    // between the outward normals of the point and of a side that faces it, negated
static constexpr double DEEPEST_BIRTH = 0.5;    // cells
static constexpr double PRESSED = 0.5;          // cells are assumed to be pressed to half at most: motion in space over that in X
static constexpr double NEAREST = 2.2;          // in cells, from the middle of a cell on the surface; no contact beyond
static constexpr double JUMP = 0.25;            // cells that X may jump between cells of a round host
static constexpr int MOST_GUESSES = 3;
static constexpr double NEAR_PLACE = 0.1;    // cells that a guess may be away from the last one

// The cell of X in a cuboid.
std::array<int, 3> ContactField::cell_of(const Vec3 &X) const
{
  const auto along = [&](double at, int axis) {
    return std::clamp(static_cast<int>(std::floor(at + LEFT)), 0, host->body->count(axis) - 1);
  };
  return {along(X.x, 0), along(X.y, 1), along(X.z, 2)};
}

// The cell of a point at x in another shape, searched from a cell near by. X depends on the cell where it is beyond all filled
// cells, or where cells are bent so much that it is in two of them. So the cell is the one whose middle is nearest, wherever the
// search began. `room`: a motion that cannot change the cell [m].
std::array<int, 3> ContactField::cell_nearest(const Vec3 &x, std::array<int, 3> cell, const Placed &at, double &room) const
{
  const Lattice grid = at.body.lattice();
  const int across = 1 + grid.row + grid.layer;    // from a cell's low corner to its high one
  for (;;) {
    std::array<int, 3> best = cell, from, to;
    for (int d = 0; d < 3; ++d) from[d] = std::max(cell[d] - 1, 0), to[d] = std::min(cell[d] + 1, grid.cells[d] - 1);
    double least = NEVER, second = NEVER;
    for (int k = from[2]; k <= to[2]; ++k)
      for (int j = from[1]; j <= to[1]; ++j) {
        const std::uint8_t *const filled = grid.filled + grid.cells[0] * (j + static_cast<std::size_t>(grid.cells[1]) * k);
        const int *const slots = at.slot + at.body.place(0, j, k);
        for (int i = from[0]; i <= to[0]; ++i) {
          if (!filled[i] || slots[i] < 0 || slots[i + across] < 0) continue;
          const Vec3 away = 0.5 * (at.place[slots[i]].value + at.place[slots[i + across]].value) - x;
          const double square = dot(away, away);
          second = std::min(second, std::max(square, least));
          if (square < least) least = square, best = {i, j, k};
        }
      }
    if (best == cell) {
      room = PRESSED * (std::sqrt(second) - std::sqrt(least));    // each of the two distances changes by this much at most
      return cell;
    }
    cell = best;
  }
}

// X of a point at x by one step of Newton's method from where it was found last. `off`: its distance from there in cells; 1 and
// more where the step tells nothing. It takes a small part of the work of find().
void ContactField::guess(std::size_t q, const Vec3 &x, const Placed &at, Spot<double> &spot, Vec3 &X, double &off)
{
  constexpr double HEALTHY = 0.7, NEARBY = 3.0;    // volume over that of a cell; cells from the middle of one
  Watch &known = watch[q];
  const bool by_splines = is_smooth(surface_point(q).kind);
  const double h = host->body->spacing();
  off = NEVER;
  if (!evaluate(at, by_splines ? smooth(known.X, at.body) : trilinear(known.X, known.cell, at.body), spot)) return;
  if (!(spot.det > HEALTHY * h * h * h)) return;
  const Vec3 change = spot.to_material(x - spot.x);
  X = known.X + change;
  const double square = dot(change, change);
  if (!(square < 1.0)) return;
  std::array<int, 3> cell = known.cell;
  bool is_there = true;
  if (by_splines)
    cell = cell_of(X);
  else
    is_there = !MaterialSearch(at).step_to_neighbour(cell, X, LEFT);
  double room = NEVER;
  if (!at.body.is_cuboid() && cell_nearest(x, cell, at, room) != cell) return;
  const Vec3 away = X - Vec3{cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5};
  if (dot(away, away) > NEARBY * NEARBY) return;
  known.cell = cell, known.X = X, known.room = room;
  off = is_there ? std::sqrt(square) : 1.0;
}

// X of a point at x, with the same bits whatever was known of it: the last search begins in the middle of the cell that X lies
// in.
bool ContactField::find(std::size_t q, const Vec3 &x, const Placed &at, Spot<double> &spot, Vec3 &X)
{
  Watch &known = watch[q];
  const MaterialSearch search(at);
  std::array<int, 3> cell = known.cell;
  X = known.X;
  if (!search.solve(x, cell, X)) return false;
  known.room = NEVER;
  cell = host->body->is_cuboid() ? cell_of(X) : cell_nearest(x, cell, at, known.room);
  X = {cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5};
  if (!search.solve(x, cell, X, false)) return false;
  known.cell = cell, known.X = X;
  if (is_smooth(surface_point(q).kind)) return search.solve_smooth(x, X) && evaluate(at, smooth(X, *host->body), spot);
  return evaluate(at, trilinear(X, cell, at.body), spot);
}

bool ContactField::world_normal(const SurfacePoint &point, const ContactArrays &arrays, Vec3 &normal) const
{
  const Placed own = {*owner->body, owner->slot.data(), arrays.place()};
  const std::array<int, 3> cell = {point.cell[0], point.cell[1], point.cell[2]};
  Spot<double> spot;
  if (!evaluate(own, trilinear({cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5}, cell, *owner->body), spot)) return false;
  const ContactBody &body = *owner->body;
  normal = spot.gradient({point.normal.x * body.edge(0), point.normal.y * body.edge(1), point.normal.z * body.edge(2)});
  const double length = std::sqrt(dot(normal, normal));
  if (!(length > 0.0)) return false;
  normal = (1.0 / length) * normal;
  return true;
}

// Ramps: half of a flat point counts one and a half cells inside of an edge, half of other points at the edge.
Ramps ContactField::ramps(PointKind kind) const
{
  Ramps ramps;
  for (int d = 0; d < 3; ++d) {
    const double rise = kind == PointKind::FLAT ? std::min(1.0, 0.25 * host->body->count(d)) : 0.5;
    ramps.width[d] = rise / (1.0 - Ramp<double>::ROUND);
    ramps.from[d] = (kind == PointKind::FLAT ? 1.5 * rise : 0.0) - 0.5 * ramps.width[d];
  }
  return ramps;
}

// The slack that judge() would give for a point so far from each side of the host that its own normal does not matter; 0 for a
// point that is nearer. Beside a cuboid some of its sides are far above the point: their edges separate it from these.
double ContactField::slack_of_far(const SurfacePoint &point, const Vec3 &X, const Vec3 &X_centre, double off) const
{
  const double least = PRESSED * (LEAST_COSINE + 1.0) + 1e-3 + off;    // cells; more than any normal can give
  const double h = host->body->spacing();
  if (!host->body->is_cuboid()) {
    const double apart = -host->body->depth(0, X).value / h;
    return apart > least ? PRESSED * h * apart : 0.0;
  }
  const Lattice grid = host->body->lattice();
  const Ramps near_edges = ramps(point.kind);
  double slack = NEVER, beyond[3];    // way to the ramp about the nearer edge, along each axis
  for (int d = 0; d < 3; ++d)
    beyond[d] = near_edges.from[d] - std::min(component(X_centre, d), grid.cells[d] - component(X_centre, d));
  for (int s = 0; s < host->body->sides(); ++s) {
    const double depth = host->body->depth(s, X).value / h;
    double of_side = -depth;    // distance from the side
    for (int d = 0; d < 3; ++d)
      if (d != s / 2) of_side = std::max(of_side, beyond[d]);
    if (of_side <= least) return 0.0;
    slack = std::min(slack, PRESSED * h * std::max(of_side, depth - DEEPEST_BIRTH));
  }
  return slack;
}

ContactField::Verdict ContactField::judge(const SurfacePoint &point, const Vec3 &X, const Vec3 &X_centre,
                                          const Spot<double> &spot, const Vec3 &normal, double off) const
{
  const double far = 1e-5 + off * off, turn = 1e-3 + 0.5 * off;    // errors of a depth and of a cosine of a guess, in cells
  const Lattice grid = host->body->lattice();
  const Ramps near_edges = ramps(point.kind);
  const double h = host->body->spacing();
  int side = -1;
  bool is_shut = false, is_surely_shut = false, may_face = false;
  double best = NEVER, until = 0.0, slack = NEVER;
  Vec3 inward_of_side;
  Verdict verdict;
  for (int s = 0; s < host->body->sides(); ++s) {
    const Depth<double> below = host->body->depth(s, X);
    const double depth = below.value / h;    // in cells
    const Vec3 inward = spot.gradient(below.slope);
    const double cosine = dot(normal, inward) / std::sqrt(dot(inward, inward));
    // Smallest change before the side can begin a contact, in cells: the largest of these three.
    double apart = -depth;
    const double turned = PRESSED * (LEAST_COSINE - cosine);
    if (host->body->is_cuboid())
      for (int d = 0; d < 3; ++d) {
        if (d == s / 2) continue;
        const double inside = std::min(component(X_centre, d), grid.cells[d] - component(X_centre, d));
        apart = std::max(apart, near_edges.from[d] - inside);
      }
    if (apart <= 0.0 || turned > apart) verdict.open |= static_cast<std::uint8_t>(1u << s);
    verdict.is_sure &= std::fabs(apart - std::max(0.0, turned)) > (turned > 0.0 ? turn : far);
    const double covered = host->body->covered(s, X);
    verdict.is_sure &= std::fabs(covered) > far + off;
    slack = std::min(slack, PRESSED * h * std::max({apart, turned, depth - DEEPEST_BIRTH}));
    if (covered >= 0.0) continue;    // another held body is there, and no point reaches this side
    is_surely_shut |= turned < -turn && depth < -far;
    may_face |= turned < turn && apart < far && depth < DEEPEST_BIRTH + far;
    if (cosine < LEAST_COSINE) continue;
    if (depth <= 0.0) {
      is_shut = true;
      until = std::max(until, std::min(-PRESSED * depth * h, 0.5 * PRESSED * h * (cosine - LEAST_COSINE)));
    } else if (depth / cosine < best) {
      best = depth / cosine, side = s, inward_of_side = inward;
      verdict.depth = below.value;
    }
  }
  verdict.is_sure &= is_surely_shut || !may_face;
  verdict.slack = is_shut ? std::max(slack, until) : slack;
  const bool is_deep = verdict.depth > DEEPEST_BIRTH * h;
  if (host->body->is_cuboid() && is_crushed(spot, *host->body)) {
    verdict.is_crushed = true;
    verdict.open = EVERY_SIDE, verdict.slack = 0.0;    // X may be different in the next step
  }
  if (side >= 0 && is_smooth(point.kind)) {
    verdict.depth *= Flattened<double>(std::sqrt(dot(inward_of_side, inward_of_side))).value;
    if (verdict.is_crushed) side = -1;
  }
  const auto counts = [&] {
    Vec3 slope;
    return !host->body->is_cuboid() || part_that_counts<double>(near_edges, grid, X_centre, side / 2, slope) > 0.0;
  };
  if (!is_shut && side >= 0 && !is_deep && counts()) verdict.side = side;
  return verdict;
}

// Whether a contact begins; otherwise sets when to look again.
bool ContactField::look(std::size_t q, const ContactArrays &arrays, bool may_begin)
{
  ++looks;
  Watch &known = watch[q];
  const SurfacePoint &point = surface_point(q);
  const Vec3 x = near.place(q, arrays.place());
  const double h = host->body->spacing();
  const Placed at = placed(arrays);
  const auto lost = [&] {
    known.cell = {-1, -1, -1};
    known.open = EVERY_SIDE;
    wake.set(q, budget);    // searched again in the next step
    return false;
  };
  if (known.cell[0] < 0) {
    const std::array<int, 3> cell = host->outer->of(*host, arrays).nearest(x, arrays.place());
    Spot<double> there;
    const Vec3 middle = {cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5};
    if (cell[0] >= 0 && !evaluate(at, trilinear(middle, cell, at.body), there)) return lost();
    const double away = cell[0] < 0 ? 0.5 * OuterCells::SEARCHED * h : std::sqrt(dot(x - there.x, x - there.x));
    if (away > NEAREST * h) {
      known.open = 0;
      wake.set(q, budget + away - NEAREST * h);
      return false;
    }
    known.cell = cell, known.X = middle;
  }
  Spot<double> spot;
  Vec3 X, normal;
  const Vec3 shift = near.shift(q, arrays.place());
  const std::uint8_t was_open = known.open;
  Verdict verdict;
  verdict.is_sure = false;
  bool has_normal = false;
  double off = 1.0;
  for (int step = 0; step < MOST_GUESSES && !verdict.is_sure && off > SAME_PLACE && off < NEVER; ++step) {
    guess(q, x, at, spot, X, off);
    if (!(off < NEAR_PLACE)) continue;
    const Vec3 X_centre = X + spot.to_material(shift);
    if (const double slack = slack_of_far(point, X, X_centre, off); slack > 0.0) {
      verdict = {};
      verdict.slack = slack;
      break;
    }
    if (!has_normal && !world_normal(point, arrays, normal)) return lost();
    has_normal = true;
    verdict = judge(point, X, X_centre, spot, normal, off);
  }
  if (!verdict.is_sure) {
    if (!find(q, x, at, spot, X) || !(has_normal || world_normal(point, arrays, normal))) return lost();
    verdict = judge(point, X, X + spot.to_material(shift), spot, normal, 0.0);
  }
  known.open = verdict.open;
  if (!may_begin || verdict.side < 0) {
    // In another cell the depth may be different.
    const double slack = std::min(verdict.slack, std::max(known.room, verdict.slack - PRESSED * JUMP * h));
    wake.set(q, budget + std::max(0.0, slack));
    return false;
  }

  FieldContact contact{};
  contact.point = near.point(q);
  contact.side = verdict.side;
  for (int d = 0; d < 3; ++d) contact.cell[d] = known.cell[d];
  contact.state.X = contact.state.anchor = X;
  contact.state.memory.depth = verdict.depth;
  contact.state.memory.offset = verdict.is_crushed || was_open >> verdict.side & 1 ? verdict.depth : 0.0;
  const auto where = std::lower_bound(of_contact.begin(), of_contact.end(), q);
  contacts.insert(contacts.begin() + (where - of_contact.begin()), contact);
  of_contact.insert(where, q);
  wake.set(q, NEVER);
  return true;
}

}    // namespace mdanim
