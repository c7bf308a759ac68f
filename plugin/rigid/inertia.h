// SPDX-License-Identifier: GPL-2.0-only
// Moments of inertia and their principal axes.

#pragma once

#include "numbers/matrix3.h"
#include "rigid/rotation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace mdanim {

// Moments about the centre: I_xx = sum m (y^2 + z^2), I_xy = -sum m x y.
struct Inertia {
  double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, xz = 0.0, yz = 0.0;
};

struct PrincipalAxes {
  Vec3 moments;    // ascending
  Quaternion q;    // takes the axes of the body into space
};

// By rotations in one plane after the other (Jacobi's method), ascending and right-handed. Moments that differ by less than
// rounding are made equal. `near`: axes that are kept where they are principal ones but for rounding; those of space need no such
// tolerance.
inline PrincipalAxes principal_axes(const Inertia &inertia, const std::optional<Quaternion> &near = {})
{
  Matrix3 about{
      {{inertia.xx, inertia.xy, inertia.xz}, {inertia.xy, inertia.yy, inertia.yz}, {inertia.xz, inertia.yz, inertia.zz}}};
  if (near) about = transposed(matrix(*near)) * about * matrix(*near);
  double a[3][3] = {{about.row[0].x, about.row[0].y, about.row[0].z},
                    {about.row[0].y, about.row[1].y, about.row[1].z},
                    {about.row[0].z, about.row[1].z, about.row[2].z}};
  const double least = near ? 1e-13 * (a[0][0] + a[1][1] + a[2][2]) : 0.0;
  for (int p = 0; p < 3; ++p)
    for (int q = 0; q < 3; ++q)
      if (p != q && std::fabs(a[p][q]) <= least) a[p][q] = 0.0;
  double axes[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};    // columns
  constexpr int SWEEPS = 30;                                                  // convergence is quadratic: some six are used
  for (int sweep = 0; sweep < SWEEPS && (a[0][1] != 0.0 || a[0][2] != 0.0 || a[1][2] != 0.0); ++sweep)
    for (const auto &[p, q] : {std::pair{0, 1}, {0, 2}, {1, 2}}) {
      if (std::fabs(a[p][q]) <= 1e-17 * (std::fabs(a[p][p]) + std::fabs(a[q][q]))) {
        a[p][q] = a[q][p] = 0.0;
        continue;
      }
      const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
      const double t = (theta < 0.0 ? -1.0 : 1.0) / (std::fabs(theta) + std::sqrt(theta * theta + 1.0));
      const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
      for (int k = 0; k < 3; ++k) {
        const double kp = a[k][p], kq = a[k][q];
        a[k][p] = c * kp - s * kq;
        a[k][q] = s * kp + c * kq;
      }
      for (int k = 0; k < 3; ++k) {
        const double pk = a[p][k], qk = a[q][k];
        a[p][k] = c * pk - s * qk;
        a[q][k] = s * pk + c * qk;
        const double ap = axes[k][p], aq = axes[k][q];
        axes[k][p] = c * ap - s * aq;
        axes[k][q] = s * ap + c * aq;
      }
      a[p][q] = a[q][p] = 0.0;
    }
  for (const auto &[p, q] : {std::pair{0, 1}, {0, 2}, {1, 2}})
    if (std::fabs(a[p][p] - a[q][q]) <= least) a[q][q] = a[p][p];
  int order[3] = {0, 1, 2};
  std::stable_sort(order, order + 3, [&](int p, int q) { return a[p][p] < a[q][q]; });
  Vec3 columns[3];
  double moments[3];
  for (int k = 0; k < 3; ++k) {
    moments[k] = a[order[k]][order[k]];
    columns[k] = {axes[0][order[k]], axes[1][order[k]], axes[2][order[k]]};
  }
  columns[2] = cross(columns[0], columns[1]);
  for (int k = 0; k < 2; ++k)
    if (moments[k + 1] - moments[k] <= 1e-13 * moments[2]) moments[k + 1] = moments[k];
  const Matrix3 rows{{columns[0], columns[1], columns[2]}};
  const Matrix3 turn{{rows * Vec3{1.0, 0.0, 0.0}, rows * Vec3{0.0, 1.0, 0.0}, rows * Vec3{0.0, 0.0, 1.0}}};
  const Quaternion found = quaternion(turn);
  return {{moments[0], moments[1], moments[2]}, near ? *near * found : found};
}

}    // namespace mdanim
