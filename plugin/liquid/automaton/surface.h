// SPDX-License-Identifier: GPL-2.0-only
// The smooth surface that acts on solids: column heights made smooth, also where a body stands in the column.

#pragma once

#include <cstdint>

namespace mdanim {

// Smooth heights (ny, nx; x fastest; NaN = none) with a filter close to a Gaussian of sigma = 2 cells, normalised over the
// columns that have a height. Columns out of its reach are filled in from around. `blocked` columns (not 0; a held wall that
// stands through the surface) have no height and pass none on: each side of a wall keeps its own level. They are filled in last,
// as are places enclosed by them where no column has a height. Equal heights stay equal to the last bit; all values are 0 where
// no column has a height. Writes (ny, nx) values, never NaN.
void smooth_surface(int nx, int ny, const double *height, const std::uint8_t *blocked, double *smooth);

}    // namespace mdanim
