// SPDX-License-Identifier: GPL-2.0-only
// Columns of a basin, cut by solids into open spans, each of which holds liquid in whole units. docs/physics-liquid.md, "Waves".

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mdanim {

using Units = std::int64_t;    // of liquid
constexpr Units UNITS_PER_CELL = 1 << 20;

// The solid part of each cell. Columns are numbered x fastest; the cells of a column lie side by side, from the lowest up.
struct SolidParts {
  static constexpr int FULL = 4096;                // a solid cell
  static constexpr int SHUT = FULL - FULL / 32;    // from this part on a cell separates the liquid above it from that below
  static constexpr Units UNITS = UNITS_PER_CELL / FULL;

  SolidParts(int nx, int ny, int nz) : nx(nx), ny(ny), nz(nz), part(static_cast<std::size_t>(nx) * ny * nz, 0) {}

  int columns() const { return nx * ny; }
  int at(int column, int z) const { return part[static_cast<std::size_t>(column) * nz + z]; }
  static constexpr int SLIVER = FULL - SHUT;    // a smaller part of a cell counts as nothing
  bool shut(int column, int z) const { return z < 0 || z >= nz || at(column, z) >= SHUT; }
  // The open part of the face between two neighbouring columns. A sliver of a cell leaks nothing, so an upright wall of one cell
  // is tight wherever it stands.
  int open_between(int a, int b, int z) const
  {
    const int open = FULL - at(a, z) - at(b, z);
    return open >= SLIVER ? open : 0;
  }

  int nx, ny, nz;
  std::vector<std::uint16_t> part;
};

// Cells [low, high) of a column between shut ones, or up to a plate that lies across it. The open parts of the shut cells at its
// ends belong to it, so its capacity changes smoothly as a body moves.
struct Span {
  int column, low, high;
  int clear;     // cells from the second one up to this one are open
  bool plain;    // all cells except those at its ends are open, so that its content gives its height
  double floor, roof;
  Units capacity;

  bool overlaps(const Span &other) const { return low < other.high && other.low < high; }
};

// Appends the spans of a column, from the lowest up. They depend on the columns beside it as well. `held` is the part of all
// solids that never moves: a plate below its upright walls, or above them, cuts the columns that these fill in part.
void cut_column(const SolidParts &solid, const SolidParts &held, int column, std::vector<Span> &spans);

struct Head {
  double height, slope;    // of the surface; d volume/d height there
};
Head head_of(const SolidParts &solid, const Span &span, Units content);
// Volume in cells. The content of a span that is level at a height is its whole units.
double volume_below(const SolidParts &solid, const Span &span, double height);
// The volume of a content in cells times the height of its middle: what lies beside a solid is lower than half of its surface.
// Liquid over capacity does not count.
double moment_of(const SolidParts &solid, const Span &span, Units content);

// Whether the plate below one of two spans of neighbouring columns continues as the plate above the other one, or the other way
// round: it passes between them, however it is tilted.
bool are_parted(const SolidParts &solid, const Span &a, const Span &b);

// The open part of the faces between two spans of neighbouring columns below a height, layer by layer. Nothing is open below the
// floor of one of them.
double open_below(const SolidParts &solid, const Span &a, const Span &b, double height);

}    // namespace mdanim
