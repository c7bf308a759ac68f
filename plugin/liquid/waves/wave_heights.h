// SPDX-License-Identifier: GPL-2.0-only
// Heights of the liquid of columns, as solids and pictures see it.

#pragma once

#include "liquid/waves/wave_exchange.h"

#include <cstdint>
#include <vector>

namespace mdanim {

// All in cells from the floor of the basin.
class WaveHeights {
 public:
  WaveHeights(int nx, int ny) : nx(nx), ny(ny), heads(nx * ny, 0.0), tops(nx * ny, 0.0), hollow(nx * ny, 0) {}

  // Finds heads of all columns; columns without liquid that solids hide get the mean of those around, at most the height of dry
  // ground. `moving` is the mass of the solids in each that can move: others are ground.
  void find(const WaveExchange &waves, int nz, const std::vector<double> &moving);

  double head(int column) const { return heads[column]; }    // of the surface that acts on solids
  const std::vector<double> &all_heads() const { return heads; }
  double top(int column) const { return tops[column]; }          // of the topmost liquid; NaN where a solid hides it
  bool is_hollow(int column) const { return hollow[column]; }    // whether a hull keeps it dry below the surface
  int top_layer() const { return above_all; }                    // no liquid in layers from this one up
  double crest() const { return highest; }                       // the highest head under open sky

 private:
  void find_of(int column, const WaveExchange &waves, int nz, bool stands);

  int nx, ny;
  std::vector<double> heads, tops;
  std::vector<std::uint8_t> hollow;
  int above_all = 0;
  double highest = 0.0;
};

}    // namespace mdanim
