// SPDX-License-Identifier: GPL-2.0-only
// Conjugate gradients. The system is scaled so that its diagonal is 1; blocks of columns correct what is smooth.

#include "liquid/waves/wave_solver.h"

#include <algorithm>

namespace mdanim {

static constexpr double NOTHING = 1e-20;

// Below a free surface alone a few steps are enough; where spans are full pressure reaches far, and blocks are worth their price.
void WaveSolver::find_heads(bool were_full)
{
  constexpr int MOST_PASSES = 4;
  const bool with_blocks = run.some_full;
  stale.assign(columns.end_row(), 1);
  for (int pass = 0; pass < MOST_PASSES; ++pass) {
    assemble(run.some_full || were_full);
    solve(pass > 0, with_blocks);
    if (run.some_full) pockets.level();
    if (!run.some_full || !let_go()) break;
    if (pass == MOST_PASSES - 1) loops.rows([&](long first, long end) { run.kernels->guess(arrays, true, first, end); });
  }
  loops.rows([&](long first, long end) { run.kernels->heads(arrays, law, first, end); });
}

void WaveSolver::assemble(bool some_full)
{
  const auto stale_rows = [this](const auto &kernel) {
    loops.rows([&](long first, long end) {
      for (long row = first; row < end; ++row)
        if (stale[row]) kernel(row);
    });
  };
  const auto is_stale = [this](long i) { return i >= columns.links_start || stale[i / columns.stride]; };
  stale_rows([&](long row) { run.kernels->assemble(arrays, law, some_full, row, row + 1); });
  loops.each_listed(columns.listed_spans, [&](long i) {
    if (is_stale(i)) general_assembly(i);
  });
  stale_rows([&](long row) { run.kernels->couple(arrays, row, row + 1); });
  loops.each_listed(columns.listed_links, [&](const LinkPlace &link) {
    if (is_stale(link.at)) general_coupling(link);
  });
}

double WaveSolver::sum_of_rows() const
{
  double sum = 0.0;
  for (long row = 1; row < columns.end_row(); ++row) sum += arrays.sums[row];
  return sum;
}

// Starts from 2 delta - last delta, or, `again`, from the values in p.
void WaveSolver::solve(bool again, bool with_blocks)
{
  const auto start_from_zero = [&](bool with_r) {
    loops.rows([&](long first, long end) {
      std::fill(arrays.x + first * columns.stride, arrays.x + end * columns.stride, 0.0);
      if (with_r)
        std::copy(arrays.rhs + first * columns.stride, arrays.rhs + end * columns.stride, arrays.r + first * columns.stride);
    });
  };

  ++run.counts.solutions;
  loops.rows([&](long first, long end) { run.kernels->guess(arrays, again, first, end); });
  const double size = sum_of_rows();
  if (!(size > NOTHING)) return start_from_zero(false);
  loops.rows([&](long first, long end) { run.kernels->start(arrays, first, end); });
  for (const long i : columns.branched) arrays.r[i] = arrays.rhs[i] - general_product(i, arrays.x);
  for (const long row : columns.branched_rows) run.kernels->sum(arrays, arrays.r, arrays.r, row, row + 1);
  double left = sum_of_rows();
  if (left > size) {    // a poor guess
    start_from_zero(true);
    left = size;
  }
  const double enough = std::max(run.tolerance * run.tolerance * size, 0.01 * NOTHING);
  if (left > enough) descend(left, enough, with_blocks);
}

// Until the square of the residual, now `left`, is `enough`.
void WaveSolver::descend(double left, double enough, bool with_blocks)
{
  if (with_blocks) {
    blocks.assemble(*run.kernels);
    loops.rows([&](long first, long end) { run.kernels->gather(arrays, blocks.row_sums(), first, end); });
  }
  const auto with_correction = [&](double square) { return with_blocks ? square + blocks.correct() : square; };
  double alpha = 0.0, beta = 0.0, fall = with_correction(left);    // `fall`: the residual times the direction of steepest descent
  for (int iteration = 0; iteration < run.most_iterations && left > enough; ++iteration) {
    const double *const lift = with_blocks ? blocks.corrections() : nullptr;
    loops.rows([&](long first, long end) { run.kernels->turn(arrays, alpha, beta, lift, first, end); });
    loops.rows([&](long first, long end) { run.kernels->product(arrays, first, end); });
    for (const long i : columns.branched) arrays.ap[i] = general_product(i, arrays.p);
    for (const long row : columns.branched_rows) run.kernels->sum(arrays, arrays.ap, arrays.p, row, row + 1);
    const double curvature = sum_of_rows();
    if (!(curvature > 0.0)) return;
    alpha = fall / curvature;
    loops.rows([&](long first, long end) {
      if (!with_blocks) return run.kernels->advance(arrays, alpha, first, end);
      for (long row = first; row < end; ++row) {
        run.kernels->advance(arrays, alpha, row, row + 1);
        run.kernels->gather(arrays, blocks.row_sums(), row, row + 1);    // while the row is at hand
      }
    });
    left = sum_of_rows();
    const double now = with_correction(left);
    beta = now / fall;
    fall = now;
    ++run.counts.iterations;
  }
  loops.rows([&](long first, long end) { run.kernels->finish(arrays, alpha, first, end); });
}

// A roof cannot pull: full spans whose head comes out below it become free. Returns whether there are any; then the heads found
// so far are in p.
bool WaveSolver::let_go()
{
  std::vector<std::uint8_t> freed(columns.end_row(), 0);
  loops.rows([&](long first, long end) {
    for (long row = first; row < end; ++row) freed[row] = let_go_in(row);
  });
  if (std::find(freed.begin(), freed.end(), 1) == freed.end()) return false;
  forget_beside(freed);
  return true;
}

bool WaveSolver::let_go_in(long row)
{
  constexpr double ROUNDING = 1e-6;
  bool any = false;
  for (long i = row * columns.stride; i < (row + 1) * columns.stride; ++i) {
    arrays.p[i] = arrays.scale[i] * arrays.x[i];
    if (arrays.full[i] == 0.0 || arrays.head[i] + arrays.p[i] >= arrays.roof[i] - ROUNDING) continue;
    const Head head = head_of(columns.solid, columns.span[i], columns.content[i]);
    arrays.full[i] = 0.0;
    arrays.p[i] += arrays.head[i] - head.height;
    arrays.head[i] = head.height;
    arrays.slope[i] = head.slope;
    any = true;
  }
  return any;
}

// A span that becomes free changes its own row of the system and those of the spans beside it, which changes their links.
void WaveSolver::forget_beside(const std::vector<std::uint8_t> &freed)
{
  constexpr long NEAR = 2;    // rows
  const long in_grid = 1 + columns.ny;
  const auto forget = [&](long row) {
    std::fill(stale.begin() + std::max(1L, row - NEAR), stale.begin() + std::min(in_grid, row + NEAR + 1), 1);
  };
  std::fill(stale.begin(), stale.begin() + in_grid, 0);    // rows of further spans are few
  for (long row = 1; row < columns.end_row(); ++row) {
    if (!freed[row]) continue;
    if (row < in_grid) forget(row);
    for (long i = row * columns.stride; row >= in_grid && i < (row + 1) * columns.stride; ++i)
      if (columns.span[i].column >= 0) forget(1 + columns.row_of(i));
  }
}

void WaveSolver::general_assembly(long i)
{
  const double head = arrays.head[i], full = arrays.full[i];
  SpanSums<double> sums;
  columns.each_link_of(i, [&](const LinkPlace &link, long other, bool inward) {
    const WaveLinks &l = columns.arrays_of(link);
    const double flux = l.height[link.at] * (l.faster[link.at] - law.dt * columns.ease(link) * law.tilt[link.d]) * law.dt;
    sums.look(head, arrays.head[other], l.wet[link.at], full, arrays.full[other], inward ? flux : 0.0 - flux);
  });
  if (full > 0.0) {
    sums.diagonal = arrays.yields[i] * (1.0 / (law.share * law.share));
    sums.rhs = full_rhs(law, arrays.volume[i], arrays.capacity[i], arrays.coming[i], sums.inflow);
  } else {
    sums.diagonal =
        free_stiffness(law, mouths.in_narrow_arm(i) ? 2.0 * law.breaking : sums.steepest, arrays.volume[i], arrays.slope[i]);
    // A partly solid column has the head that it will have: otherwise liquid under nearly shut cells would rise and fall for
    // ever.
    if (arrays.slope[i] < POROUS) sums.rhs = sums.inflow / (law.dt * law.dt);
  }
  arrays.beside_full[i] = sums.beside_full;
  const double stiffness = sums.diagonal;
  columns.each_link_of(i, [&](const LinkPlace &link, long other, bool inward) {
    const WaveLinks &l = columns.arrays_of(link);
    sums.couple(head, arrays.head[other], l.edge[link.at], l.height[link.at] * columns.ease(link),
                inward ? law.tilt[link.d] : -law.tilt[link.d]);
  });
  const bool solved = sums.diagonal > 0.0;
  arrays.scale[i] = 1.0 / root(solved ? sums.diagonal : 1.0);
  arrays.flat[i] = sums.diagonal > stiffness && i < columns.further_start ? 1.0 / arrays.scale[i] : 0.0;
  arrays.rhs[i] = solved ? sums.rhs * arrays.scale[i] : 0.0;
}

void WaveSolver::general_coupling(const LinkPlace &link)
{
  const WaveLinks &l = columns.arrays_of(link);
  const Ends e = columns.ends(link);
  const double bare = coupling(arrays.head[e.a], arrays.head[e.b], l.edge[link.at], l.height[link.at] * columns.ease(link));
  l.couple[link.at] = bare * arrays.scale[e.a] * arrays.scale[e.b];
}

double WaveSolver::general_product(long i, const double *x) const
{
  double sum = x[i];
  columns.each_link_of(
      i, [&](const LinkPlace &link, long other, bool) { sum -= columns.arrays_of(link).couple[link.at] * x[other]; });
  return sum;
}

}    // namespace mdanim
