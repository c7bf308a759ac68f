// SPDX-License-Identifier: GPL-2.0-only

#include "contact/material_map.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

static constexpr int MOST_STEPS = 16;
static constexpr double DONE = 1e-11;        // of a cell edge
static constexpr double FARTHEST = 4.0;      // cells from the middle of the last cell within which a result is trusted
static constexpr double ON_THE_WAY = 0.2;    // cells by which X may be outside of a cell before it is found

static Vec3 middle(const std::array<int, 3> &cell) { return {cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5}; }

bool MaterialSearch::is_collapsed(const Spot<double> &spot) const { return !(spot.det > smallest_volume(host.body.spacing())); }

bool MaterialSearch::step_to_neighbour(std::array<int, 3> &cell, const Vec3 &X, double over) const
{
  int next[3] = {cell[0], cell[1], cell[2]};
  if (!mdanim::step_to_neighbour(host.body.lattice(), next, X, over)) return false;
  cell = {next[0], next[1], next[2]};
  return true;
}

bool MaterialSearch::solve(const Vec3 &x, std::array<int, 3> &cell, Vec3 &X, bool walk) const
{
  const double near = DONE * host.body.spacing();
  Spot<double> spot;
  for (int step = 0; step < MOST_STEPS; ++step) {
    if (!evaluate(host, trilinear(X, cell, host.body), spot) || is_collapsed(spot)) return false;
    const Vec3 miss = x - spot.x;
    const bool done = dot(miss, miss) < near * near;
    if (!done) {
      const Vec3 change = spot.to_material(miss);
      const double far = length(change);
      X += (far > 1.0 ? 1.0 / far : 1.0) * change;
      if (length(X - middle(cell)) > FARTHEST) return false;
    }
    if (walk && step_to_neighbour(cell, X, done ? 1e-12 : ON_THE_WAY)) continue;
    if (done) return true;
  }
  return false;
}

bool MaterialSearch::solve_around(const Vec3 &x, std::array<int, 3> &cell, Vec3 &X) const
{
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        std::array<int, 3> trial = {cell[0] + i, cell[1] + j, cell[2] + k};
        if (!host.body.is_filled(trial[0], trial[1], trial[2])) continue;
        Vec3 found = middle(trial);
        if (!solve(x, trial, found, false)) continue;
        const Vec3 off = found - middle(trial);
        if (std::max({std::fabs(off.x), std::fabs(off.y), std::fabs(off.z)}) >= 0.51) continue;
        cell = trial, X = found;
        return true;
      }
  return false;
}

bool MaterialSearch::solve_smooth(const Vec3 &x, Vec3 &X) const
{
  const double near = DONE * host.body.spacing();
  Spot<double> spot;
  for (int step = 0; step < MOST_STEPS; ++step) {
    if (!evaluate(host, smooth(X, host.body), spot) || is_collapsed(spot)) return false;
    const Vec3 miss = x - spot.x;
    if (dot(miss, miss) < near * near) return true;
    const Vec3 change = spot.to_material(miss);
    const double far = length(change);
    X += (far > 0.5 ? 0.5 / far : 1.0) * change;
  }
  return false;
}

}    // namespace mdanim
