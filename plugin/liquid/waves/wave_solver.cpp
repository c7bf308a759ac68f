// SPDX-License-Identifier: GPL-2.0-only
// Conjugate gradients. The system is scaled so that its diagonal is 1.

#include "liquid/waves/wave_solver.h"

#include <algorithm>
#include <utility>

namespace mdanim {

void WaveSolver::find_heads(bool were_full)
{
  constexpr int MOST_PASSES = 4;
  for (int pass = 0; pass < MOST_PASSES; ++pass) {
    assemble(run.some_full || were_full);
    solve(pass > 0);
    if (!run.some_full || !let_go()) break;
    if (pass == MOST_PASSES - 1) loops.rows([&](long first, long end) { run.kernels->guess(arrays, true, first, end); });
  }
  loops.rows([&](long first, long end) { run.kernels->heads(arrays, law, first, end); });
}

void WaveSolver::assemble(bool some_full)
{
  loops.rows([&](long first, long end) { run.kernels->assemble(arrays, law, some_full, first, end); });
  loops.each_listed(columns.listed_spans, [&](long i) { general_assembly(i); });
  loops.rows([&](long first, long end) { run.kernels->couple(arrays, first, end); });
  loops.each_listed(columns.listed_links, [&](const LinkPlace &link) { general_coupling(link); });
}

double WaveSolver::sum_of_rows() const
{
  double sum = 0.0;
  for (long row = 1; row < columns.end_row(); ++row) sum += arrays.sums[row];
  return sum;
}

// Starts from 2 delta - last delta, or, `again`, from the values in p.
void WaveSolver::solve(bool again)
{
  constexpr double NOTHING = 1e-20;
  const auto start_from_zero = [&](bool with_r) {
    loops.rows([&](long first, long end) {
      std::fill(arrays.x + first * columns.stride, arrays.x + end * columns.stride, 0.0);
      if (with_r)
        std::copy(arrays.rhs + first * columns.stride, arrays.rhs + end * columns.stride, arrays.r + first * columns.stride);
    });
  };
  // Completes A x where there are further links, and the sums of rows in which these are.
  const auto complete = [&](double *product, const double *x, const double *with) {
    for (const long i : columns.branched) product[i] = general_product(i, x);
    for (const long row : columns.branched_rows) run.kernels->sum(arrays, product, with, row, row + 1);
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
  const double enough = run.tolerance * run.tolerance * size;
  double beta = 0.0;
  for (int iteration = 0; iteration < run.most_iterations && left > enough && left > 0.01 * NOTHING; ++iteration) {
    loops.rows([&](long first, long end) { run.kernels->turn(arrays, beta, first, end); });
    complete(arrays.ap, arrays.next_p, arrays.next_p);
    const double curvature = sum_of_rows();
    if (!(curvature > 0.0)) break;
    const double alpha = left / curvature;
    loops.rows([&](long first, long end) { run.kernels->advance(arrays, alpha, first, end); });
    std::swap(arrays.p, arrays.next_p);
    const double now = sum_of_rows();
    beta = now / left;
    left = now;
    ++run.counts.iterations;
  }
}

// A roof cannot pull: full spans whose head comes out below it become free. Returns whether there are any; then the heads found
// so far are in p.
bool WaveSolver::let_go()
{
  return loops.any_row([this](long first, long end) { return let_go(first, end); });
}

bool WaveSolver::let_go(long first, long end)
{
  constexpr double ROUNDING = 1e-6;
  bool any = false;
  for (long i = first * columns.stride; i < end * columns.stride; ++i) {
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
  columns.each_link_of(i, [&](const LinkPlace &link, long other, bool inward) {
    const WaveLinks &l = columns.arrays_of(link);
    sums.couple(head, arrays.head[other], l.edge[link.at], l.height[link.at] * columns.ease(link),
                inward ? law.tilt[link.d] : -law.tilt[link.d]);
  });
  const bool solved = sums.diagonal > 0.0;
  arrays.scale[i] = 1.0 / root(solved ? sums.diagonal : 1.0);
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
