// SPDX-License-Identifier: GPL-2.0-only
// Conjugate gradients for what heads gain in an update. The system is scaled so that its diagonal is 1.

#include "liquid/waves.h"

#include <utility>

namespace mdanim {

double Waves::sum_of_rows() const
{
  double sum = 0.0;
  for (long row = 1; row < end_row(); ++row) sum += arrays.sums[row];
  return sum;
}

// From 2 delta - last delta, or, `again`, from what is in p.
void Waves::solve(bool again)
{
  constexpr double NOTHING = 1e-20;
  const long end = end_row();
  // A x where there are further links, and the sums of rows in which these are.
  const auto complete = [&](double *product, const double *x, const double *with) {
    for (const long i : branched) product[i] = general_product(i, x);
    for (const long row : branched_rows) kernels->sum(arrays, product, with, row, row + 1);
  };

  ++counts.solutions;
  kernels->guess(arrays, again, 1, end);
  const double size = sum_of_rows();
  if (!(size > NOTHING)) {
    for (long i = stride; i < end * stride; ++i) arrays.x[i] = 0.0;
    return;
  }
  kernels->start(arrays, 1, end);
  for (const long i : branched) arrays.r[i] = arrays.rhs[i] - general_product(i, arrays.x);
  for (const long row : branched_rows) kernels->sum(arrays, arrays.r, arrays.r, row, row + 1);
  double left = sum_of_rows();
  if (left > size) {    // a poor guess
    for (long i = stride; i < end * stride; ++i) {
      arrays.x[i] = 0.0;
      arrays.r[i] = arrays.rhs[i];
    }
    left = size;
  }
  const double enough = tolerance * tolerance * size;
  double beta = 0.0;
  for (int iteration = 0; iteration < most_iterations && left > enough && left > 0.01 * NOTHING; ++iteration) {
    kernels->turn(arrays, beta, 1, end);
    complete(arrays.ap, arrays.next_p, arrays.next_p);
    const double curvature = sum_of_rows();
    if (!(curvature > 0.0)) break;
    kernels->advance(arrays, left / curvature, 1, end);
    std::swap(arrays.p, arrays.next_p);
    const double now = sum_of_rows();
    beta = now / left;
    left = now;
    ++counts.iterations;
  }
}

}    // namespace mdanim
