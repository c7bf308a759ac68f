// SPDX-License-Identifier: GPL-2.0-only
// Systems of blocks, and a cycle of multigrid.

#include "liquid/waves/wave_blocks.h"

#include <algorithm>

namespace mdanim {

namespace {

constexpr int EDGE = WaveKernels::BLOCK;
constexpr double PART = 0.8;      // of a step by the diagonal
constexpr double SOFTER = 1.5;    // heads of blocks of blocks bend in steps, and take more force for it than smooth ones

int blocks_in(int n, int edge) { return (n + edge - 1) / edge; }

}    // namespace

WaveBlocks::Level::Level(int nx, int ny) : nx(nx), ny(ny)
{
  for (auto *of : {&diagonal, &inverse, &east, &north, &f, &x, &change}) of->assign((nx + 1) * (ny + 2) + 1, 0.0);
}

WaveBlocks::WaveBlocks(const WaveColumns &columns) : columns(columns)
{
  levels.emplace_back(blocks_in(columns.nx, EDGE), blocks_in(columns.ny, EDGE));
  while (levels.back().nx > 1 || levels.back().ny > 1)
    levels.emplace_back(blocks_in(levels.back().nx, 2), blocks_in(levels.back().ny, 2));
}

void WaveBlocks::assemble(const WaveKernels &kernels)
{
  Level &first = levels[0];
  const long blocks = columns.stride / EDGE;
  for (auto *of : {&diagonal, &couple[0], &couple[1]}) of->resize(first.ny * blocks);
  kernels.blocks(columns.arrays, {diagonal.data(), {couple[0].data(), couple[1].data()}, 1L + columns.ny}, 0, first.ny);
  for (int y = 0; y < first.ny; ++y) {
    std::copy_n(&diagonal[y * blocks], first.nx, &first.diagonal[first.place(0, y)]);
    std::copy_n(&couple[0][y * blocks], first.nx, &first.east[first.place(0, y)]);
    std::copy_n(&couple[1][y * blocks], first.nx, &first.north[first.place(0, y)]);
  }
  complete(first);
  for (std::size_t n = 1; n < levels.size(); ++n) sum_up(levels[n - 1], levels[n]);
  gathered.resize(columns.end_row() * blocks);
  lift.resize((1 + columns.end_row() / EDGE) * columns.stride);
}

void WaveBlocks::sum_up(const Level &from, Level &to)
{
  for (auto *of : {&to.diagonal, &to.east, &to.north}) std::fill(of->begin(), of->end(), 0.0);
  for (int y = 0; y < from.ny; ++y)
    for (int x = 0; x < from.nx; ++x) {
      const long i = from.place(x, y), block = to.place(x / 2, y / 2);
      to.diagonal[block] += from.diagonal[i];
      (x % 2 ? to.east[block] : to.diagonal[block]) += x % 2 ? from.east[i] : -2.0 * from.east[i];
      (y % 2 ? to.north[block] : to.diagonal[block]) += y % 2 ? from.north[i] : -2.0 * from.north[i];
    }
  const auto links = [&](long i) { return (to.east[i - 1] + to.east[i]) + (to.north[i - to.nx - 1] + to.north[i]); };
  to.each([&](long i) { to.diagonal[i] -= (1.0 - 1.0 / SOFTER) * links(i); });
  for (auto *of : {&to.east, &to.north})
    for (double &c : *of) c *= 1.0 / SOFTER;
  complete(to);
}

void WaveBlocks::complete(Level &level)
{
  level.each([&](long i) { level.inverse[i] = level.diagonal[i] > 0.0 ? 1.0 / level.diagonal[i] : 0.0; });
}

double WaveBlocks::correct()
{
  Level &first = levels[0];
  const long blocks = columns.stride / EDGE;
  for (int y = 0; y < first.ny; ++y) {
    double *const f = &first.f[first.place(0, y)];
    std::fill_n(f, first.nx, 0.0);
    for (long row = 1 + EDGE * y; row < std::min(1 + EDGE * (y + 1), 1 + columns.ny); ++row)
      for (int x = 0; x < first.nx; ++x) f[x] += gathered[row * blocks + x];
  }
  cycle(0);
  double sum = 0.0;
  for (int y = 0; y < first.ny; ++y) {
    double of_row = 0.0;
    double *to = lift.data() + y * columns.stride;
    for (int x = 0; x < first.nx; ++x) {
      const long i = first.place(x, y);
      of_row += first.f[i] * first.x[i];
      std::fill_n(to + EDGE * x, EDGE, first.x[i]);
    }
    sum += of_row;
  }
  return sum;
}

// Symmetric: steps by the diagonal before and after those of larger blocks.
void WaveBlocks::cycle(std::size_t n)
{
  Level &l = levels[n];
  if (n + 1 == levels.size()) {
    l.each([&](long i) { l.x[i] = l.f[i] * l.inverse[i]; });
    return;
  }
  l.each([&](long i) { l.x[i] = PART * l.f[i] * l.inverse[i]; });
  Level &next = levels[n + 1];
  std::fill(next.f.begin(), next.f.end(), 0.0);
  for (int y = 0; y < l.ny; ++y)
    for (int x = 0; x < l.nx; ++x) {
      const long i = l.place(x, y);
      next.f[next.place(x / 2, y / 2)] += (1.0 - PART) * l.f[i] + l.beside(i);
    }
  cycle(n + 1);
  for (int y = 0; y < l.ny; ++y)
    for (int x = 0; x < l.nx; ++x) l.x[l.place(x, y)] += next.x[next.place(x / 2, y / 2)];
  l.each([&](long i) { l.change[i] = PART * (l.inverse[i] * (l.f[i] + l.beside(i)) - l.x[i]); });
  l.each([&](long i) { l.x[i] += l.change[i]; });
}

}    // namespace mdanim
