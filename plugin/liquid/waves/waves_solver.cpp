// SPDX-License-Identifier: GPL-2.0-only
// Conjugate gradients for the change of heads in an update. The system is scaled so that its diagonal is 1.

#include "liquid/waves/waves.h"

#include <algorithm>
#include <utility>

namespace mdanim {

double Waves::sum_of_rows() const
{
  double sum = 0.0;
  for (long row = 1; row < end_row(); ++row) sum += arrays.sums[row];
  return sum;
}

// Starts from 2 delta - last delta, or, `again`, from the values in p.
void Waves::solve(bool again)
{
  constexpr double NOTHING = 1e-20;
  const auto start_from_zero = [&](bool with_r) {
    rows([&](long first, long end) {
      std::fill(arrays.x + first * stride, arrays.x + end * stride, 0.0);
      if (with_r) std::copy(arrays.rhs + first * stride, arrays.rhs + end * stride, arrays.r + first * stride);
    });
  };
  // Completes A x where there are further links, and the sums of rows in which these are.
  const auto complete = [&](double *product, const double *x, const double *with) {
    for (const long i : branched) product[i] = general_product(i, x);
    for (const long row : branched_rows) kernels->sum(arrays, product, with, row, row + 1);
  };

  ++counts.solutions;
  rows([&](long first, long end) { kernels->guess(arrays, again, first, end); });
  const double size = sum_of_rows();
  if (!(size > NOTHING)) return start_from_zero(false);
  rows([&](long first, long end) { kernels->start(arrays, first, end); });
  for (const long i : branched) arrays.r[i] = arrays.rhs[i] - general_product(i, arrays.x);
  for (const long row : branched_rows) kernels->sum(arrays, arrays.r, arrays.r, row, row + 1);
  double left = sum_of_rows();
  if (left > size) {    // a poor guess
    start_from_zero(true);
    left = size;
  }
  const double enough = tolerance * tolerance * size;
  double beta = 0.0;
  for (int iteration = 0; iteration < most_iterations && left > enough && left > 0.01 * NOTHING; ++iteration) {
    rows([&](long first, long end) { kernels->turn(arrays, beta, first, end); });
    complete(arrays.ap, arrays.next_p, arrays.next_p);
    const double curvature = sum_of_rows();
    if (!(curvature > 0.0)) break;
    const double alpha = left / curvature;
    rows([&](long first, long end) { kernels->advance(arrays, alpha, first, end); });
    std::swap(arrays.p, arrays.next_p);
    const double now = sum_of_rows();
    beta = now / left;
    left = now;
    ++counts.iterations;
  }
}

}    // namespace mdanim
