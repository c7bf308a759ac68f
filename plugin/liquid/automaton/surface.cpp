// SPDX-License-Identifier: GPL-2.0-only
// A normalised filter by repeated steps of diffusion, after which columns without a value are filled in from around.

#include "liquid/automaton/surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <vector>

namespace mdanim {

namespace {

// A step mixes a column with its four neighbours and widens the filter by 2 MIX along each axis: sigma^2 = 2
// MIX STEPS = 4.
constexpr int STEPS = 10;
constexpr float MIX = 0.2f;
constexpr double FAR = std::numeric_limits<double>::infinity();

// Free columns joined through free ones, and the lowest and highest of the heights in them.
struct Region {
  double lowest = FAR, highest = -FAR;
  bool has_height() const { return lowest <= highest; }
};

// Free columns side by side in a row.
struct ColumnRun {
  std::size_t place;     // of the first one, here
  std::size_t number;    // of the first one, in arrays without a rim
  int length, region;
};

// Columns with a rim of one column around, so that neighbours need no test of bounds.
class Surface {
 public:
  void read(int columns_x, int columns_y, const double *height, const std::uint8_t *blocked);
  bool level() const;
  void spread_level();
  void filter(const double *height);
  void fill(bool blocked_too);
  void write(double *smooth) const;

 private:
  void find_runs();
  void find_regions();
  void step();
  double mean_around(std::size_t place) const;

  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y + 1) * row + x + 1; }
  std::array<std::size_t, 4> around(std::size_t place) const { return {place - 1, place + 1, place - row, place + row}; }
  void set(std::size_t place, double height)
  {
    value[place] = height;
    known[place] = 1;
  }

  int nx = 0, ny = 0, row = 0;
  std::vector<ColumnRun> runs;
  std::vector<Region> regions;
  std::vector<int> parent;    // of runs: a forest with a tree per region
  std::vector<std::uint8_t> free, known, wanted;
  std::vector<double> value;        // 0 where not known
  std::vector<float> keep, take;    // factors of a column and of its neighbours in a step
  std::vector<float> sum, weight, next_sum, next_weight;
  std::vector<std::size_t> ring, next_ring;
  std::vector<double> means;
};

void Surface::read(int columns_x, int columns_y, const double *height, const std::uint8_t *blocked)
{
  nx = columns_x, ny = columns_y, row = nx + 2;
  const std::size_t size = static_cast<std::size_t>(row) * (ny + 2);
  for (auto *bytes : {&free, &known, &wanted}) bytes->assign(size, 0);
  value.assign(size, 0.0);
  for (int y = 0; y < ny; ++y)
    for (int x = 0; x < nx; ++x) free[at(x, y)] = blocked[static_cast<std::size_t>(y) * nx + x] == 0;
  find_runs();
  find_regions();
  for (const ColumnRun &run : runs) {
    double lowest = FAR, highest = -FAR;
    for (int n = 0; n < run.length; ++n) {    // NaN compares false
      const double h = height[run.number + n];
      lowest = h < lowest ? h : lowest;
      highest = h > highest ? h : highest;
    }
    Region &r = regions[run.region];
    r.lowest = std::min(r.lowest, lowest);
    r.highest = std::max(r.highest, highest);
  }
}

void Surface::find_runs()
{
  runs.clear();
  for (int y = 0; y < ny; ++y)
    for (int x = 0; x < nx; ++x) {
      const auto first = free.begin() + at(x, y), last = free.begin() + at(nx, y);
      const int length = std::find(first, last, 0) - first;
      if (length > 0) runs.push_back({at(x, y), static_cast<std::size_t>(y) * nx + x, length, 0});
      x += length;
    }
}

void Surface::find_regions()
{
  parent.resize(runs.size());
  const auto root = [&](std::size_t run) {
    while (parent[run] != static_cast<int>(run)) run = parent[run] = parent[parent[run]];
    return static_cast<int>(run);
  };
  const auto end = [&](std::size_t run) { return runs[run].place + runs[run].length; };
  std::size_t below = 0;    // in the row before, the first run that may touch this one
  for (std::size_t r = 0; r < runs.size(); ++r) {
    parent[r] = r;
    while (end(below) + row <= runs[r].place) ++below;
    for (std::size_t b = below; b < r && runs[b].place + row < end(r); ++b) {
      const int p = root(r), q = root(b);
      parent[std::max(p, q)] = std::min(p, q);
    }
  }
  regions.clear();
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const int first = root(r);
    runs[r].region = first == static_cast<int>(r) ? static_cast<int>(regions.size()) : runs[first].region;
    if (first == static_cast<int>(r)) regions.emplace_back();
  }
}

bool Surface::level() const
{
  return std::none_of(regions.begin(), regions.end(), [](const Region &r) { return r.lowest < r.highest; });
}

// A region with only one height has that height everywhere, bit for bit.
void Surface::spread_level()
{
  for (const ColumnRun &run : runs)
    if (regions[run.region].has_height())
      for (int n = 0; n < run.length; ++n) set(run.place + n, regions[run.region].lowest);
}

// Sum of weight times height over sum of weights, both spread in the same steps without flux into blocked
// columns or out of the grid. Heights count from the lowest of the region, so that a level region stays
// exactly level beside one that is not, and single precision, which halves the time, costs less than 1e-5
// cell in waves of tens of cells.
void Surface::filter(const double *height)
{
  for (auto *numbers : {&keep, &take, &sum, &weight, &next_sum, &next_weight}) numbers->assign(value.size(), 0.0f);
  for (const ColumnRun &run : runs)
    for (int n = 0; n < run.length; ++n) {
      const std::size_t place = run.place + n;
      keep[place] = 1.0f - MIX * (free[place - 1] + free[place + 1] + free[place - row] + free[place + row]);
      take[place] = MIX;
      const bool has_height = !std::isnan(height[run.number + n]);
      sum[place] = has_height ? static_cast<float>(height[run.number + n] - regions[run.region].lowest) : 0.0f;
      weight[place] = has_height ? 1.0f : 0.0f;
    }
  for (int n = 0; n < STEPS; ++n) step();
  for (const ColumnRun &run : runs)
    for (std::size_t place = run.place; place < run.place + run.length; ++place)
      if (weight[place] > 0.0f) set(place, regions[run.region].lowest + static_cast<double>(sum[place]) / weight[place]);
}

// Opposite neighbours are added first: mirrored or transposed heights give mirrored or transposed bits.
void Surface::step()
{
  for (int y = 0; y < ny; ++y) {
    const std::size_t first = at(0, y);
    const float *const k = &keep[first], *const t = &take[first];
    const float *const s = &sum[first], *const w = &weight[first];
    float *const new_s = &next_sum[first], *const new_w = &next_weight[first];
#pragma GCC ivdep
    for (int x = 0; x < nx; ++x) {
      new_s[x] = k[x] * s[x] + t[x] * ((s[x - 1] + s[x + 1]) + (s[x - row] + s[x + row]));
      new_w[x] = k[x] * w[x] + t[x] * ((w[x - 1] + w[x + 1]) + (w[x - row] + w[x + row]));
    }
  }
  sum.swap(next_sum);
  weight.swap(next_weight);
}

// Gives every column without a value the mean of its neighbours' values, ring by ring.
void Surface::fill(bool blocked_too)
{
  const auto want = [&](std::size_t place, std::vector<std::size_t> &list) {
    if (!wanted[place]) return;
    wanted[place] = 0;
    list.push_back(place);
  };
  ring.clear();
  for (int y = 0; y < ny; ++y)
    for (std::size_t n = at(0, y); n < at(nx, y); ++n) wanted[n] = (known[n] ^ 1) & (free[n] | static_cast<int>(blocked_too));
  for (int y = 0; y < ny; ++y) {
    if (!std::memchr(&wanted[at(0, y)], 1, nx)) continue;
    for (std::size_t place = at(0, y); place < at(nx, y); ++place) {
      const auto [left, right, down, up] = around(place);
      if (known[left] | known[right] | known[down] | known[up]) want(place, ring);
    }
  }
  while (!ring.empty()) {
    means.clear();
    for (const std::size_t place : ring) means.push_back(mean_around(place));
    for (std::size_t n = 0; n < ring.size(); ++n) set(ring[n], means[n]);
    next_ring.clear();
    for (const std::size_t place : ring)
      for (const std::size_t n : around(place)) want(n, next_ring);
    ring.swap(next_ring);
  }
}

double Surface::mean_around(std::size_t place) const
{
  const auto [left, right, down, up] = around(place);
  const int count = known[left] + known[right] + known[down] + known[up];
  double lowest = FAR, highest = -FAR;
  for (const std::size_t n : around(place)) {
    lowest = known[n] ? std::min(lowest, value[n]) : lowest;
    highest = known[n] ? std::max(highest, value[n]) : highest;
  }
  // Rounding must not change the mean of equal heights.
  return std::clamp(((value[left] + value[right]) + (value[down] + value[up])) / count, lowest, highest);
}

void Surface::write(double *smooth) const
{
  for (int y = 0; y < ny; ++y) std::copy_n(&value[at(0, y)], nx, smooth + static_cast<std::size_t>(y) * nx);
}

}    // namespace

void smooth_surface(int nx, int ny, const double *height, const std::uint8_t *blocked, double *smooth)
{
  thread_local Surface surface;    // keeps its buffers: fresh pages would cost as much as the filter
  surface.read(nx, ny, height, blocked);
  if (surface.level())
    surface.spread_level();
  else
    surface.filter(height);
  surface.fill(false);
  surface.fill(true);
  surface.write(smooth);
}

}    // namespace mdanim
