// SPDX-License-Identifier: GPL-2.0-only
// Newton's method in a cell, and the cell that a point is in.

#include "contact/point_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mdanim {

static constexpr double NEVER = std::numeric_limits<double>::infinity();

// The cell of X in a cuboid.
std::array<int, 3> PointSearch::cell_of(const Vec3 &X) const
{
  const auto along = [&](double place, int axis) {
    return std::clamp(static_cast<int>(std::floor(place + LEFT)), 0, at.body.count(axis) - 1);
  };
  return {along(X.x, 0), along(X.y, 1), along(X.z, 2)};
}

// Calls see(cell, square of the distance of its middle from x) for a cell and those around it that are filled and here.
template <class See> void PointSearch::each_around(const Vec3 &x, const std::array<int, 3> &cell, const See &see) const
{
  const Lattice grid = at.body.lattice();
  const int across = 1 + grid.row + grid.layer;    // from a cell's low corner to its high one
  std::array<int, 3> from, to;
  for (int d = 0; d < 3; ++d) from[d] = std::max(cell[d] - 1, 0), to[d] = std::min(cell[d] + 1, grid.cells[d] - 1);
  for (int k = from[2]; k <= to[2]; ++k)
    for (int j = from[1]; j <= to[1]; ++j) {
      const std::uint8_t *const filled = grid.filled + grid.cells[0] * (j + static_cast<std::size_t>(grid.cells[1]) * k);
      const int *const slots = at.slot + at.body.place(0, j, k);
      for (int i = from[0]; i <= to[0]; ++i) {
        if (!filled[i] || slots[i] < 0 || slots[i + across] < 0) continue;
        const Vec3 away = 0.5 * (at.place[slots[i]].value + at.place[slots[i + across]].value) - x;
        see(std::array<int, 3>{i, j, k}, dot(away, away));
      }
    }
}

std::array<int, 3> PointSearch::outer_around(const Vec3 &x, const std::array<int, 3> &cell, double &away) const
{
  std::array<int, 3> best = cell;
  double least = NEVER;
  each_around(x, cell, [&](const std::array<int, 3> &one, double square) {
    if (square < least && at.body.is_outer(one[0], one[1], one[2])) least = square, best = one;
  });
  away = std::sqrt(least);
  return best;
}

// Whether a cell is that of a point at x whose search begins at `start`, in a round host.
bool PointSearch::is_cell_of(const Vec3 &x, const std::array<int, 3> &cell, const std::array<int, 3> &start, double &room) const
{
  double away;
  if (cell == start && at.body.is_outer(cell[0], cell[1], cell[2])) return cell_nearest(x, cell, room) == cell;
  return cell_nearest(x, outer_around(x, start, away), room) == cell;
}

// The cell of a point at x in another shape, from the nearest cell on the surface. X depends on the cell where it is beyond all
// filled cells, or where cells are bent so much that it is in two of them. So the cell is the one whose middle is nearest, as far
// as neighbours tell. `room`: a motion that cannot change the cell [m].
std::array<int, 3> PointSearch::cell_nearest(const Vec3 &x, std::array<int, 3> cell, double &room) const
{
  for (;;) {
    std::array<int, 3> best = cell;
    double least = NEVER, second = NEVER;
    each_around(x, cell, [&](const std::array<int, 3> &one, double square) {
      second = std::min(second, std::max(square, least));
      if (square < least) least = square, best = one;
    });
    if (best == cell) {
      room = PRESSED * (std::sqrt(second) - std::sqrt(least));    // each of the two distances changes by this much at most
      return cell;
    }
    cell = best;
  }
}

bool PointSearch::confirm_cell(PointTrack &known, const Vec3 &x, double budget) const
{
  double room = NEVER;
  if (budget < known.certain) return true;
  if (!at.body.is_cuboid() && !is_cell_of(x, known.cell, known.start, room)) return false;
  known.certain = budget + room;
  return true;
}

void PointSearch::guess(PointTrack &known, const Vec3 &x, double budget, bool by_splines, Spot<double> &spot, Vec3 &X,
                        double &off) const
{
  constexpr double NEARBY = 3.0;    // cells from the middle of one
  const double h = at.body.spacing();
  off = NEVER;
  if (!evaluate(at, by_splines ? smooth(known.X, at.body) : trilinear(known.X, known.cell, at.body), spot)) return;
  if (!(spot.det > WHOLE_CELL * h * h * h)) return;
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
  const Vec3 away = X - Vec3{cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5};
  if (dot(away, away) > NEARBY * NEARBY) return;
  PointTrack there = known;
  there.move_to(cell, X);
  if (!confirm_cell(there, x, budget)) return;
  known = there;
  off = is_there ? std::sqrt(square) : 1.0;
}

bool PointSearch::find(PointTrack &known, const Vec3 &x, double budget, bool by_splines, Spot<double> &spot, Vec3 &X) const
{
  const MaterialSearch search(at);
  std::array<int, 3> cell = known.cell;
  double room = NEVER;
  if (at.body.is_cuboid()) {
    X = known.X;
    if (!search.solve(x, cell, X)) return false;
    cell = cell_of(X);
  } else {
    cell = cell_nearest(x, cell, room);
  }
  X = {cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5};
  if (!search.solve(x, cell, X, false)) return false;
  known.cell = cell, known.X = X, known.certain = budget + room;
  if (by_splines) return search.solve_smooth(x, X) && evaluate(at, smooth(X, at.body), spot);
  return evaluate(at, trilinear(X, cell, at.body), spot);
}

}    // namespace mdanim
