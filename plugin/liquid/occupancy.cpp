// SPDX-License-Identifier: GPL-2.0-only
// Sampling lattice cells.

#include "liquid/occupancy.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace mdanim {

Occupancy::Occupancy(int nx, int ny, int nz) : nx(nx), ny(ny), nz(nz), count(static_cast<std::size_t>(nx) * ny * nz, 0) {}

void Occupancy::add(const Vec3 &place, int weight, CellBox &reached)
{
  // Written so that a place with NaN is outside.
  if (!(place.x >= 0.0 && place.x < nx && place.y >= 0.0 && place.y < ny && place.z >= 0.0 && place.z < nz)) return;
  const int x = static_cast<int>(place.x), y = static_cast<int>(place.y), z = static_cast<int>(place.z);
  count[number(x, y, z)] += weight;
  reached.take_in(x, y, z);
}

void Occupancy::add_particle(const Vec3 &place) { add(place, FULL, touched); }

namespace {

// A lattice cell by its mean edges; their triple product is its volume, however it is turned or squeezed.
struct MeanEdges {
  Vec3 a, b, c;

  explicit MeanEdges(const Vec3 corner[8])
      : a(0.25 * ((corner[1] - corner[0]) + (corner[2] - corner[3]) + (corner[5] - corner[4]) + (corner[6] - corner[7]))),
        b(0.25 * ((corner[3] - corner[0]) + (corner[2] - corner[1]) + (corner[7] - corner[4]) + (corner[6] - corner[5]))),
        c(0.25 * ((corner[4] - corner[0]) + (corner[5] - corner[1]) + (corner[6] - corner[2]) + (corner[7] - corner[3])))
  {
  }
  // Weight of one of 27 samples; a cell at rest counts as 27 * full.
  int weight(double full) const { return static_cast<int>(std::min(1.0e3, std::fabs(dot(cross(a, b), c))) * full + 0.5); }
};

}    // namespace

// 3x3x3 points of a lattice cell.
struct Occupancy::Samples {
  static constexpr int COUNT = 27;
  double at[3][COUNT];

  explicit Samples(const Vec3 corner[8])
  {
    static constexpr double AT[3] = {1.0 / 6.0, 0.5, 5.0 / 6.0};
    int n = 0;
    for (const double w : AT) {
      const Vec3 p0 = corner[0] + w * (corner[4] - corner[0]), p1 = corner[1] + w * (corner[5] - corner[1]);
      const Vec3 p2 = corner[2] + w * (corner[6] - corner[2]), p3 = corner[3] + w * (corner[7] - corner[3]);
      for (const double v : AT) {
        const Vec3 left = p0 + v * (p3 - p0), right = p1 + v * (p2 - p1), along = right - left;
        for (const double u : AT) {
          at[0][n] = left.x + u * along.x;
          at[1][n] = left.y + u * along.y;
          at[2][n] = left.z + u * along.z;
          ++n;
        }
      }
    }
  }
};

bool Occupancy::add(const Vec3 corner[8], bool spread, int layers, const RowSlabs::Rows &rows, CellBox &reached)
{
  constexpr double BESIDE = 1.5;    // rows beyond the corners
  const auto [low, high] =
      std::minmax({corner[0].y, corner[1].y, corner[2].y, corner[3].y, corner[4].y, corner[5].y, corner[6].y, corner[7].y});
  if (!(rows.low == 0 || low - BESIDE >= rows.low) || !(rows.high == ny || high + BESIDE < rows.high)) return false;
  if (!spread)
    add_points(corner, reached);
  else if (layers < 0 || !fill_inside(corner, layers, reached))
    add_spread(corner, reached);
  return true;
}

void Occupancy::add_points(const Vec3 corner[8], CellBox &reached)
{
  const int weight = MeanEdges(corner).weight(FULL / 27.0);
  if (weight == 0) return;
  const Samples samples(corner);
  for (int n = 0; n < Samples::COUNT; ++n) add({samples.at[0][n], samples.at[1][n], samples.at[2][n]}, weight, reached);
}

void Occupancy::add_spread(const Vec3 corner[8], CellBox &reached)
{
  const MeanEdges edges(corner);
  const int weight = edges.weight(FULL_SPREAD / 27.0);
  if (weight == 0) return;
  // The box around a third of the cell along each edge.
  const auto half = [](double a, double b, double c) {
    return std::min(0.5, (std::fabs(a) + std::fabs(b) + std::fabs(c)) / 6.0);
  };
  const Spread spread{
      {half(edges.a.x, edges.b.x, edges.c.x), half(edges.a.y, edges.b.y, edges.c.y), half(edges.a.z, edges.b.z, edges.c.z)},
      static_cast<std::uint32_t>(weight)};
  const int cells[3] = {nx, ny, nz};
  double low[3] = {corner[0].x, corner[0].y, corner[0].z}, high[3] = {low[0], low[1], low[2]}, sum = 0.0;
  for (int k = 0; k < 8; ++k) {
    const double at[3] = {corner[k].x, corner[k].y, corner[k].z};
    for (int d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], at[d]);
      high[d] = std::max(high[d], at[d]);
      sum += at[d];
    }
  }
  if (!std::isfinite(sum)) return;
  bool inside = true;
  for (int d = 0; d < 3; ++d) {
    low[d] -= spread.reach[d];
    high[d] += spread.reach[d];
    if (high[d] < 0.0 || low[d] >= cells[d]) return;
    inside = inside && low[d] >= 0.0 && high[d] + 1.0 < cells[d];
  }
  for (int d = 0; d < 3; ++d) {
    reached.low[d] = std::min(reached.low[d], static_cast<int>(std::max(0.0, low[d])));
    reached.high[d] = std::max(reached.high[d], static_cast<int>(std::min(cells[d] - 1.0, high[d] + 1.0)) + 1);
  }
  const Samples samples(corner);
  if (inside)
    spread_samples<true>(samples, spread);
  else
    spread_samples<false>(samples, spread);
}

// The eight cells nearest to the middle are within 1.5 of it along each axis. Their corner may be 2.6 away, but less than 1 % of
// a cell with its corner that far is farther than 2.4. Together they leave no gap where corners of lattice cells are within 1 of
// a middle. The outermost of these lattice cells spread their samples as well, because those reach beyond the eight.
bool Occupancy::fill_inside(const Vec3 corner[8], int layers, CellBox &reached)
{
  constexpr double FURTHEST = 2.4, LONGEST = 1.15;
  const Vec3 edges[] = {corner[1] - corner[0], corner[3] - corner[0], corner[4] - corner[0]};
  double shortest = LONGEST * LONGEST;
  for (const Vec3 &edge : edges) {
    const double length = dot(edge, edge);
    if (!(length <= LONGEST * LONGEST)) return false;
    shortest = std::min(shortest, length);
  }
  const double beyond = layers + 0.5 - FURTHEST / std::sqrt(shortest);    // lattice cells
  if (beyond < 0.0) return false;
  const Vec3 middle = 0.5 * (corner[0] + corner[6]);
  const double place[3] = {middle.x, middle.y, middle.z};
  const int cells[3] = {nx, ny, nz};
  int low[3], high[3];
  for (int d = 0; d < 3; ++d) {
    if (!(place[d] > -1.5 && place[d] < cells[d] + 1.5)) return true;    // all of it is outside
    const int nearest = static_cast<int>(place[d] + 2.5) - 2;
    low[d] = std::max(0, nearest - 1);
    high[d] = std::min(cells[d], nearest + 1);
    if (low[d] >= high[d]) return true;
  }
  for (int d = 0; d < 3; ++d) {    // only now: a box that has grown along some axes alone is not a box
    reached.low[d] = std::min(reached.low[d], low[d]);
    reached.high[d] = std::max(reached.high[d], high[d]);
  }
  for (int z = low[2]; z < high[2]; ++z)
    for (int y = low[1]; y < high[1]; ++y)
      for (int x = low[0]; x < high[0]; ++x) count[number(x, y, z)] |= FILLED;
  return beyond >= 1.0;
}

static bool within(int n, int many) { return n >= 0 && n < many; }

// Along each axis the upper of two cells gets its share, in 1/SHARES, and the lower one the whole rest, so that nothing is lost.
template <bool INSIDE> void Occupancy::spread_samples(const Samples &samples, const Spread &spread)
{
  constexpr int COUNT = Samples::COUNT;
  int lower[3][COUNT];
  std::uint32_t upper_share[3][COUNT];
  for (int d = 0; d < 3; ++d)
    for (int n = 0; n < COUNT; ++n) {
      const double low = samples.at[d][n] - spread.reach[d], high = samples.at[d][n] + spread.reach[d];
      lower[d][n] = static_cast<int>(low + 1.0) - 1;    // low is at least -1 if any part is inside
      const int share = static_cast<int>((high - (lower[d][n] + 1)) * spread.shares[d] + 0.5);
      upper_share[d][n] = static_cast<std::uint32_t>(std::max(0, share));
    }
  std::uint32_t part[8][COUNT];    // bits of the first number: upper along x, y, z
  for (int n = 0; n < COUNT; ++n) part[0][n] = spread.weight;
  for (int d = 2; d >= 0; --d)
    for (int k = 0; k < 8; k += 2 << d)
      for (int n = 0; n < COUNT; ++n) {
        const std::uint32_t upper = part[k][n] * upper_share[d][n] / Spread::SHARES;
        part[k + (1 << d)][n] = upper;
        part[k][n] -= upper;
      }
  const int cells[3] = {nx, ny, nz};
  const std::ptrdiff_t row = nx, layer = row * ny;
  int *const counts = count.data();
  for (int n = 0; n < COUNT; ++n) {
    const int x = lower[0][n], y = lower[1][n], z = lower[2][n];
    int *const at = counts + (z * layer + y * row + x);    // one before the row where x is -1
    if (INSIDE) {
      for (int k = 0; k < 8; ++k) at[(k & 1) + (k >> 1 & 1) * row + (k >> 2) * layer] += static_cast<int>(part[k][n]);
      continue;
    }
    bool outside = false;
    for (int d = 0; d < 3; ++d)
      outside = outside || samples.at[d][n] + spread.reach[d] < 0.0 || samples.at[d][n] - spread.reach[d] >= cells[d];
    for (int k = 0; k < 8 && !outside; ++k) {
      const bool is_there[3] = {within(x + (k & 1), nx), within(y + (k >> 1 & 1), ny), within(z + (k >> 2), nz)};
      if (is_there[0] && is_there[1] && is_there[2])
        at[(k & 1) + (k >> 1 & 1) * row + (k >> 2) * layer] += static_cast<int>(part[k][n]);
    }
  }
}

void Occupancy::begin_mass() { sums.resize(static_cast<std::size_t>(3) * nx * ny, 0); }

void Occupancy::add_mass(const Vec3 &place, double mass, double softness, double rising)
{
  if (!(place.x >= 0.0 && place.x <= nx && place.y >= 0.0 && place.y <= ny)) return;
  const double x = std::clamp(place.x - 0.5, 0.0, nx - 1.0), y = std::clamp(place.y - 0.5, 0.0, ny - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y), x1 = std::min(x0 + 1, nx - 1), y1 = std::min(y0 + 1, ny - 1);
  const double u = x - x0, v = y - y0;
  const auto give = [&](int cx, int cy, double part) {
    std::int64_t *const of_column = &sums[3 * (static_cast<std::size_t>(cy) * nx + cx)];
    of_column[0] += static_cast<std::int64_t>(mass * part / SUM_UNIT + 0.5);
    of_column[1] += static_cast<std::int64_t>(softness * part / SUM_UNIT + 0.5);
    of_column[2] += static_cast<std::int64_t>(std::floor(mass * part * rising / SUM_UNIT + 0.5));
  };
  give(x0, y0, (1.0 - u) * (1.0 - v));
  give(x1, y0, u * (1.0 - v));
  give(x0, y1, (1.0 - u) * v);
  give(x1, y1, u * v);
}

CellBox Occupancy::count_anew(const std::function<void(Occupancy &)> &add_bodies, const RankSums &ranks, const Threads &threads)
{
  CellBox before_or_now = touched;
  clear(threads);
  add_bodies(*this);
  sum_over(ranks, threads);
  before_or_now.take_in(touched);
  return before_or_now;
}

void Occupancy::clear(const Threads &threads)
{
  constexpr double CELL = 0.2;    // [ns], approximately
  std::fill(sums.begin(), sums.end(), 0);
  touched.each_row(threads, CELL, [this](int y, int z) {
    const auto first = count.begin() + static_cast<std::ptrdiff_t>(number(0, y, z));
    std::fill(first + touched.low[0], first + touched.high[0], 0);
  });
  touched = CellBox();
}

// Only the box that any rank has touched is summed over ranks.
void Occupancy::sum_over(const RankSums &ranks, const Threads &threads)
{
  constexpr double CELL = 0.3;    // [ns], approximately
  if (!ranks.alone()) add_all(ranks);
  touched.each_row(threads, CELL, [this](int y, int z) {
    for (std::size_t c = number(touched.low[0], y, z), end = number(touched.high[0], y, z); c < end; ++c)
      count[c] = std::min(count[c], FILLED);
  });
}

void Occupancy::add_all(const RankSums &ranks)
{
  int bounds[7];
  for (int d = 0; d < 3; ++d) {
    bounds[d] = touched.low[d];
    bounds[3 + d] = -touched.high[d];
  }
  bounds[6] = sums.empty() ? 0 : -1;
  ranks.lowest(bounds, 7);
  if (bounds[6]) {    // some rank has mass
    sums.resize(static_cast<std::size_t>(3) * nx * ny, 0);
    ranks.add_wide(sums.data(), static_cast<int>(sums.size()));
  }
  for (int d = 0; d < 3; ++d) {
    touched.low[d] = bounds[d];
    touched.high[d] = -bounds[3 + d];
  }
  if (touched.empty()) return;
  std::vector<int> part(touched.size());
  const int width = touched.high[0] - touched.low[0];
  const auto rows = [&](auto &&copy) {
    int *packed = part.data();
    for (int z = touched.low[2]; z < touched.high[2]; ++z)
      for (int y = touched.low[1]; y < touched.high[1]; ++y, packed += width) copy(&count[number(touched.low[0], y, z)], packed);
  };
  rows([&](const int *grid, int *packed) { std::copy_n(grid, width, packed); });
  ranks.add(part.data(), static_cast<int>(part.size()));
  rows([&](int *grid, const int *packed) { std::copy_n(packed, width, grid); });
}

}    // namespace mdanim
