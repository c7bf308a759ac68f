// SPDX-License-Identifier: GPL-2.0-only
// The forces of a liquid with momentum on the bodies in it, cell by cell. docs/physics-liquid.md, "Bodies in waves".

#pragma once

#include "liquid/occupancy.h"
#include "liquid/waves/added_mass.h"
#include "liquid/waves/waves.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace mdanim {

// Computed once for each update, for the cells that bodies fill and those around them.
class WavePush {
 public:
  // The force on a volume in a cell, over the weight of as much liquid. s is the fraction below `head`.
  struct OnCell {
    enum Number {
      SHARE,     // factor of s: 0 where it is dry below
      OVER,      // of the liquid whose head below is higher than the body, per thickness of the body
      BESIDE,    // the same by the surface around, less what stands on the body
      ALONG_X,
      ALONG_Y,    // push sideways, times s + beside where that is positive
      ON_TOP,     // of the liquid that stands on the body, by the body's thickness
      FLOW_X,
      FLOW_Y,    // velocity of the liquid
      NUMBERS
    };
    double head = 0.0;
    std::array<double, NUMBERS> of{};
    bool operator==(const OnCell &other) const { return head == other.head && of == other.of; }
  };

  WavePush(int nx, int ny, int nz)
      : nx(nx), ny(ny), nz(nz), known(static_cast<std::size_t>(nx) * ny * nz, -1),
        ambient(static_cast<std::size_t>(nx) * ny, std::numeric_limits<double>::quiet_NaN()), added(nx, ny),
        close(static_cast<std::size_t>(nx) * ny, 0), depths(static_cast<std::size_t>(nx) * ny)
  {
  }

  // Computes forces for all columns with mass in them; `since` is the time since the last update, 0 where nothing moves. The
  // sideways push follows the liquid by a part of its change: a body is stiffer sideways than the time of an update shows.
  void find(const Waves &waves, const AddedMass::Solids *solids, double part, double since);
  // The number of a cell among all(); -1 far from all bodies.
  int number_of(std::size_t cell) const { return known[cell]; }
  const std::vector<OnCell> &all() const { return found; }
  // Values of the columns: everything else that find() depends on.
  std::vector<double> &state() { return ambient; }
  const std::vector<double> &state() const { return ambient; }
  std::vector<AddedMass::Column> &added_state() { return added.state(); }
  const std::vector<AddedMass::Column> &added_state() const { return added.state(); }
  double energy() const { return added.energy(); }
  // Whether below all solids of a column there is liquid in a gap that cells do not resolve.
  bool is_close(int column) const { return close[column]; }
  double bytes() const
  { return static_cast<double>(known.size() * sizeof known[0] + found.capacity() * (sizeof(OnCell) + sizeof(std::size_t))); }

 private:
  // A solid from one height to another in a column, between two spans or beside one; -1 where there is none.
  struct SolidRun {
    int column, below, above;
    double bottom, top;
    bool wet, told;    // whether liquid is below; whether that is known: where no liquid gets below, from the columns around
    bool seeps;        // whether liquid seeps into a gap that cells do not resolve
    double phi, floor;
    double u[4], over, beside, on_top;
    bool moves;    // whether it moves liquid up and down
  };

  void cut(const Waves &waves, int column);
  bool beside(const Waves &waves, int column, double bottom, double top, double &phi) const;
  void seep(const Waves &waves);
  double seen_at(const Waves &waves, int column) const;
  void follow(const Waves &waves, double part);
  void find_close(const Waves &waves);
  void take_along(const Waves &waves, const AddedMass::Solids *solids, double since);
  void press(const Waves &waves, SolidRun &run);
  void put(const SolidParts &solid, int column, int z, const SolidRun *stands, OnCell on);
  void fill(const Waves &waves, int column);
  void spread(const SolidParts &solid);

  struct NextTo {
    OnCell on;
    double weight, wet;
    std::size_t cell;
  };
  bool is_among(std::size_t own, int x, int y, int z) const;

  const int nx, ny, nz;
  std::vector<int> known;            // of each cell, its number in `found`, or -1
  std::vector<OnCell> found;         // one for many cells above each other with the same values
  std::vector<std::size_t> cells;    // cells whose values are known
  std::vector<NextTo> next_to;       // a buffer of spread()
  std::vector<SolidRun> runs;
  std::vector<int> first_run, columns;    // first run of each column, or -1; columns with mass
  std::vector<double> ambient;            // head around each column, as it acts sideways; NaN far from bodies
  AddedMass added;
  std::vector<std::uint8_t> close;          // see is_close()
  std::vector<AddedMass::Depths> depths;    // for the run of each column that moves liquid
};

}    // namespace mdanim
