// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/bed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace mdanim {

namespace {

constexpr double LEAST_SPOT = 1e-3;                          // area of a place where contact acts, over the mean of corners
constexpr double BALANCED = 1e-9, NEARLY_BALANCED = 1e-5;    // what is left of the force, and of the torque over the size
constexpr double LEAST_PART = 1e-6;                          // of a step of Newton's method
constexpr double RIDGE = 1e-12;                              // of the diagonal: spots on a line do not resist turning about it
constexpr int MOST_STEPS = 50;

using Three = std::array<double, 3>;

// (1, x, y) of a spot over the size of the bed, and its area.
struct OnBed {
  Three own;
  double area;
};

double product(const Three &a, const Three &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Solves the symmetric positive matrix, of which the lower part counts.
Three solved(std::array<Three, 3> m, Three x)
{
  for (int k = 0; k < 3; ++k)
    for (int i = k + 1; i < 3; ++i) {
      const double part = m[i][k] / m[k][k];
      for (int j = k + 1; j <= i; ++j) m[i][j] -= part * m[j][k];
      x[i] -= part * x[k];
    }
  for (int k = 2; k >= 0; --k) {
    x[k] /= m[k][k];
    for (int i = 0; i < k; ++i) x[i] -= m[k][i] * x[k];
  }
  return x;
}

// The plane a + b x + c y of the pressure: the least of sum area max(0, plane)^2/2 - wanted . plane, by Newton's method. Returns
// whether it was found.
bool find_plane(const std::vector<OnBed> &places, const Three &wanted, Three &plane)
{
  const auto value = [&](const Three &of) {
    double all = -product(wanted, of);
    for (const OnBed &one : places) {
      const double p = std::max(0.0, product(of, one.own));
      all += 0.5 * one.area * p * p;
    }
    return all;
  };
  plane = {1.0, 0.0, 0.0};    // all of them bear
  double now = HUGE_VAL, off = HUGE_VAL;
  for (int step = 0; step < MOST_STEPS; ++step) {
    Three left = wanted;
    std::array<Three, 3> m{};
    for (const OnBed &one : places) {
      const double p = product(plane, one.own);
      if (p <= 0.0) continue;
      const Three &x = one.own;
      for (int k = 0; k < 3; ++k) {
        left[k] -= one.area * p * x[k];
        for (int j = 0; j <= k; ++j) m[k][j] += one.area * x[k] * x[j];
      }
    }
    off = std::max({std::fabs(left[0]), std::fabs(left[1]), std::fabs(left[2])});
    if (off <= BALANCED) return true;
    const double ridge = RIDGE * (m[0][0] + m[1][1] + m[2][2]);
    for (int k = 0; k < 3; ++k) m[k][k] += ridge;
    const Three way = solved(m, left);
    double part = 1.0;
    for (; part > LEAST_PART; part *= 0.5) {
      const Three next{plane[0] + part * way[0], plane[1] + part * way[1], plane[2] + part * way[2]};
      const double then = value(next);
      if (!(then < now)) continue;
      plane = next, now = then;
      break;
    }
    if (part <= LEAST_PART) break;    // as near as roundings let it come
  }
  return off <= NEARLY_BALANCED;
}

}    // namespace

void Bed::press(int piece, const Vec3 &centre, const Vec3 &force, const Vec3 &torque)
{
  const double along = dot(n, force);
  const Vec3 middle = flat(centre);
  if (along > 0.0)
    pressed.push_back({piece, centre, middle + (1.0 / along) * cross(n, torque + cross(centre - middle, force)), along});
}

void Bed::spread(PieceMotions &more)
{
  if (spots.empty() || pressed.empty()) return;
  const auto which = [](const BedSpot &one) { return std::pair{one.piece, one.corner}; };
  std::sort(spots.begin(), spots.end(), [&](const BedSpot &a, const BedSpot &b) { return which(a) < which(b); });
  const auto end =
      std::unique(spots.begin(), spots.end(), [&](const BedSpot &a, const BedSpot &b) { return which(a) == which(b); });
  spots.erase(end, spots.end());
  std::vector<BedSpot> all = spots;
  double area = 0.0, size = 0.0, force = 0.0;
  for (const BedSpot &one : spots) area += one.area / static_cast<double>(spots.size());
  // Where contact presses: a spot there bears what no corner beside it can.
  for (const BedPress &one : pressed) all.push_back({one.piece, -1, one.centre, one.at, LEAST_SPOT * area});
  const Vec3 middle = pressed.front().at;
  const Vec3 e1 = unit(cross(n, std::fabs(n.x) < 0.5 ? Vec3{1.0, 0.0, 0.0} : Vec3{0.0, 1.0, 0.0})), e2 = cross(n, e1);
  for (const BedSpot &one : all) size = std::max(size, length(flat(one.at) - middle));
  if (!(size > 0.0)) return;
  const auto place = [&](const Vec3 &x) { return Three{1.0, dot(x - middle, e1) / size, dot(x - middle, e2) / size}; };
  std::vector<OnBed> places;
  for (const BedSpot &one : all) places.push_back({place(one.at), one.area});
  Three wanted{}, plane;
  for (const BedPress &one : pressed) force += one.force;
  for (const BedPress &one : pressed)
    for (int k = 0; k < 3; ++k) wanted[k] += one.force / force * place(one.at)[k];
  if (!find_plane(places, wanted, plane)) return;
  Vec3 left, turns;    // roundings
  const auto add = [&](int piece, const Vec3 &centre, const Vec3 &at, double press) {
    const Vec3 own = press * n;
    more[piece].place += own;
    more[piece].turn += cross(at - centre, own);
    left -= own;
    turns -= cross(at - middle, own);
  };
  for (std::size_t k = 0; k < all.size(); ++k)
    if (const double p = product(plane, places[k].own); p > 0.0)
      add(all[k].piece, all[k].centre, flat(all[k].at), force * all[k].area * p);
  for (const BedPress &one : pressed) add(one.piece, one.centre, one.at, -one.force);
  const BedPress &one = pressed.front();
  more[one.piece].place += left;
  more[one.piece].turn += turns - cross(one.centre - middle, left);
}

}    // namespace mdanim
