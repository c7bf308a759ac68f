// SPDX-License-Identifier: GPL-2.0-only
// The liquid that moves up and down with floating bodies. docs/physics-liquid.md, (W14) to (W16).

#pragma once

#include <cstdint>
#include <vector>

namespace mdanim {

// Heights and lengths in cells, masses and forces of a column in those of a cell of liquid, times in sqrt(cell/g).
class AddedMass {
 public:
  struct Depths {
    double below = 0.0, above = 0.0;    // of the liquid that touches solids; none is taken along where there is none below
    double bottom = 0.0;                // height of the lower face of these solids
  };
  struct Solids {
    double mass = 0.0, velocity = 0.0;    // of the moving solids of a column; upwards
  };
  struct Column {
    double mass = 0.0, force = 0.0, velocity = 0.0;    // of the liquid that moves along, and its push on the solids, upwards
  };

  AddedMass(int nx, int ny);

  // For the columns `with` solids; `depths` and `solids` are of all columns. start() is for the first update, or where nothing
  // moves; `since` is the time since the last update.
  void start(const std::vector<int> &with, const Depths *depths, const Solids *solids);
  void follow(const std::vector<int> &with, const Depths *depths, const Solids *solids, double since);
  double force_on(int column) const { return columns[column].force; }
  double energy() const;
  std::vector<Column> &state() { return columns; }
  const std::vector<Column> &state() const { return columns; }

 private:
  double most_at(const Depths &depths, int column) const;
  double flatness(int column, const Depths *depths) const;
  void find_distances(const std::vector<int> &with, const Depths *depths);
  void find_accelerations(const std::vector<int> &with, const Depths *depths, const Solids *solids, double since);

  const int nx, ny;
  std::vector<Column> columns;

  // buffers
  std::vector<Column> was;
  std::vector<double> distances;        // from the middle of each column to the edge of the area that is wet from below
  std::vector<double> accelerations;    // for each column
  std::vector<std::uint8_t> seen;
  std::vector<int> body;
};

}    // namespace mdanim
