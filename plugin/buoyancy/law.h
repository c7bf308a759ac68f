// SPDX-License-Identifier: GPL-2.0-only
// Buoyancy and drag of a liquid on a particle. Wcislo 1999, sec. 4.3; docs/physics-liquid.md.

#pragma once

#include "numbers/real.h"

#include <algorithm>

namespace mdanim {

// Part of a particle's volume that is below the surface: s = clip((eta - z)/h + 1/2, 0, 1), in units of the
// cell height h, with `eta` the depth of the liquid there and `z` the particle's height, both above the
// basin's floor. Liquid shallower than a cell immerses in proportion, so that a dry floor lifts nothing.
inline double immersed_part(double eta, double z) { return std::clamp(eta - z + 0.5, 0.0, 1.0) * std::clamp(eta, 0.0, 1.0); }

// Upward force on volume V with the part s immersed: Archimedes, rho_l V s g. Equal to the paper's modified
// gravity g (1 - s rho_l/rho_s) on a particle of mass rho_s V.
template <class Real> MDANIM_ALWAYS_INLINE Real lift(double rho, const Real &volume, const Real &s, double g)
{ return rho * volume * s * g; }

// Friction coefficient of the immersed part, eq. (3.9): F = -gamma rho_l V s v. Quadratic drag is a gamma that grows with |v|.
template <class Real> MDANIM_ALWAYS_INLINE Real liquid_lambda(const Real &gamma, double rho, const Real &volume, const Real &s)
{ return gamma * rho * volume * s; }

// Value at (x, y) of a field known at the centres of unit cells, bilinear, constant beyond the outermost centres. A blocked cell
// (not 0) takes the value of the cell of the point, so that nothing is mixed across a wall.
inline double at_point(const double *field, const unsigned char *blocked, int nx, int ny, double x, double y)
{
  const long own =
      static_cast<long>(std::clamp(static_cast<int>(y), 0, ny - 1)) * nx + std::clamp(static_cast<int>(x), 0, nx - 1);
  const auto value = [&](int cx, int cy) {
    const long c = static_cast<long>(cy) * nx + cx;
    return field[blocked[c] ? own : c];
  };
  const double px = std::clamp(x - 0.5, 0.0, nx - 1.0), py = std::clamp(y - 0.5, 0.0, ny - 1.0);
  const int x0 = std::min(static_cast<int>(px), std::max(0, nx - 2)), x1 = std::min(x0 + 1, nx - 1);
  const int y0 = std::min(static_cast<int>(py), std::max(0, ny - 2)), y1 = std::min(y0 + 1, ny - 1);
  const double u = px - x0, v = py - y0;
  // a + u (b - a): a constant field stays constant to the last bit
  const double a = value(x0, y0), b = value(x1, y0), c = value(x0, y1), d = value(x1, y1);
  const double below = a + u * (b - a), above = c + u * (d - c);
  return below + v * (above - below);
}

}    // namespace mdanim
