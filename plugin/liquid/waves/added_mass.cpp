// SPDX-License-Identifier: GPL-2.0-only
// Distances to the edges of bodies, their accelerations, and the force in each column.

#include "liquid/waves/added_mass.h"

#include "liquid/waves/columns.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

namespace {

constexpr double REACH = 2.0;    // of the motion away from a body, in distances to its edge
constexpr double EDGE = 0.75;    // beyond the middle of the last column that is wet from below: the next one is half covered
constexpr double ENTRY = 1.0;    // time over which liquid is taken along, in sqrt(cell/g)
constexpr double FASTEST_GAIN = 3.0;    // in that time, over the mass that moves already: light bodies would be thrown back
constexpr double HIGHEST = 8.0;         // cells of liquid
constexpr double NOWHERE = 1e9;

// (W14)
double mass_within(double depth, double distance)
{
  if (depth <= 0.0) return 0.0;
  const double reach = REACH * distance;
  return 1.0 / std::sqrt(9.0 / (depth * depth) + 1.0 / (reach * reach));
}

}    // namespace

AddedMass::AddedMass(int nx, int ny) : nx(nx), ny(ny), columns(static_cast<std::size_t>(nx) * ny) {}

void AddedMass::start(const std::vector<int> &with, const Depths *depths, const Solids *solids)
{
  find_distances(with, depths);
  for (const int c : with)
    if (depths[c].below > 0.0) columns[c] = {most_at(depths[c], c), 0.0, solids[c].velocity};
}

void AddedMass::follow(const std::vector<int> &with, const Depths *depths, const Solids *solids, double since)
{
  find_distances(with, depths);
  was.assign(columns.size(), Column{});
  was.swap(columns);
  find_accelerations(with, depths, solids, since);
  for (const int c : with) {
    if (depths[c].below <= 0.0) continue;
    const Column &before = was[c];
    Column &now = columns[c];
    const double own = solids[c].mass, most = most_at(depths[c], c);
    now.velocity = solids[c].velocity;
    now.mass = std::min(most, before.mass + std::min(most, FASTEST_GAIN * (own + before.mass)) * since / ENTRY);
    const double taken = std::max(0.0, now.mass - before.mass) * std::max(0.0, -now.velocity) / since;
    // (W16)
    const double expected = (own * accelerations[c] - before.force + taken) / (own + now.mass);
    now.force = std::clamp(taken - now.mass * expected, -HIGHEST, HIGHEST);
  }
}

double AddedMass::energy() const
{
  double sum = 0.0;
  for (const Column &column : columns) sum += 0.5 * column.mass * column.velocity * column.velocity;
  return sum;
}

double AddedMass::most_at(const Depths &depths, int column) const
{ return mass_within(depths.below, distances[column]) + mass_within(depths.above, distances[column]); }

// By two passes over neighbours, forth and back. Along a bottom that rises a way counts less: liquid gets out of the way aslant.
void AddedMass::find_distances(const std::vector<int> &with, const Depths *depths)
{
  const double diagonal = std::sqrt(2.0);
  distances.assign(columns.size(), 0.0);
  for (const int c : with)
    if (depths[c].below > 0.0) distances[c] = NOWHERE;
  const auto pass = [&](int c, int way) {
    if (depths[c].below <= 0.0) return;
    const double flat = flatness(c, depths);
    const auto from = [&](int dx, int dy, double step) {
      const int x = c % nx + dx, y = c / nx + dy;
      if (x < 0 || x >= nx || y < 0 || y >= ny) return;
      const int other = y * nx + x;
      const double from_there = depths[other].below > 0.0 ? step : step + (EDGE - 1.0);
      distances[c] = std::min(distances[c], distances[other] + flat * from_there);
    };
    from(-way, 0, 1.0);
    from(0, -way, 1.0);
    from(-way, -way, diagonal);
    from(way, -way, diagonal);
  };
  for (std::size_t n = 0; n < with.size(); ++n) pass(with[n], 1);
  for (std::size_t n = with.size(); n-- > 0;) pass(with[n], -1);
}

// Square of the upward part of the normal of what is wet from below.
double AddedMass::flatness(int column, const Depths *depths) const
{
  double steep[2] = {0.0, 0.0};
  for (int side = 0; side < 4; ++side) {
    const int other = neighbour(column, side, nx, ny);
    if (other < 0 || depths[other].below <= 0.0) continue;
    double &along = steep[side / 2];
    along = std::max(along, std::fabs(depths[other].bottom - depths[column].bottom));
  }
  return 1.0 / (1.0 + steep[0] * steep[0] + steep[1] * steep[1]);
}

// (W15): the acceleration of connected columns, as of a rigid body.
void AddedMass::find_accelerations(const std::vector<int> &with, const Depths *depths, const Solids *solids, double since)
{
  accelerations.assign(columns.size(), 0.0);
  seen.assign(columns.size(), 0);
  for (const int first : with) {
    if (seen[first] || depths[first].below <= 0.0) continue;
    body.assign(1, first);
    seen[first] = 1;
    for (std::size_t n = 0; n < body.size(); ++n)
      for (int side = 0; side < 4; ++side) {
        const int other = neighbour(body[n], side, nx, ny);
        if (other < 0 || seen[other] || depths[other].below <= 0.0) continue;
        seen[other] = 1;
        body.push_back(other);
      }
    double all = 0.0, x = 0.0, y = 0.0, a = 0.0;
    const auto each = [&](const auto &f) {
      for (const int c : body)
        if (was[c].mass > 0.0) f(solids[c].mass, c % nx - x, c / nx - y, (solids[c].velocity - was[c].velocity) / since);
    };
    double sum_x = 0.0, sum_y = 0.0;
    each([&](double m, double px, double py, double pa) { all += m, sum_x += m * px, sum_y += m * py, a += m * pa; });
    if (all == 0.0) continue;
    x = sum_x / all, y = sum_y / all, a /= all;
    double xx = 0.0, xy = 0.0, yy = 0.0, xa = 0.0, ya = 0.0;
    each([&](double m, double px, double py, double pa) {
      xx += m * px * px, xy += m * px * py, yy += m * py * py, xa += m * px * pa, ya += m * py * pa;
    });
    const double determinant = xx * yy - xy * xy;
    const bool flat = determinant > 1e-6 * all * all;
    const double along_x = flat ? (xa * yy - ya * xy) / determinant : 0.0,
                 along_y = flat ? (ya * xx - xa * xy) / determinant : 0.0;
    for (const int c : body) accelerations[c] = a + along_x * (c % nx - x) + along_y * (c / nx - y);
  }
}

}    // namespace mdanim
