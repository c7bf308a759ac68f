// SPDX-License-Identifier: GPL-2.0-only
// The liquid's automaton on a plain integer grid: vertical rule (4.16), random 2x2 permutations, displacement by solids. No rule
// gains or loses a unit. Wcislo 1999, sec. 4; docs/physics-liquid.md tells how damaged lines are read.

#pragma once

#include "liquid/automaton/cells.h"
#include "threads/team.h"

#include <cstdint>
#include <vector>

namespace mdanim {

// The excess that moves up in (4.16), line 2, besides L > 1: only into a cell that holds less, or into any (below
// Cells::FULLEST).
enum class Vertical { LOWER, ANY };

// The cells of a basin and the rules that move liquid in them. It keeps for each layer whether some rule can change it, and for
// each 2x2 block whether solid cells break it.
class Automaton {
 public:
  Automaton(int nx, int ny, int nz, std::uint64_t seed, Vertical vertical = Vertical::LOWER);

  Cells cells;

  // One sweep: horizontal (even), vertical (a), horizontal (odd), vertical (b). `when` keys its random numbers. Layers that no
  // rule can change are skipped.
  void sweep(std::uint64_t when);

  // Makes exactly these cells solid: 0 open, 1 solid, 2 solid and still; nx*ny*nz values, x fastest. The liquid of a newly solid
  // cell goes, whole, to a random open face neighbour with room for it, else to a random such cell of the nearest (Chebyshev)
  // shell that has one. Returns the number of cells that changed between open and solid. Throws std::runtime_error when there is
  // no room, and leaves everything as it was.
  long displace(const std::uint8_t *solid, std::uint64_t when);

  // Pours one unit each into empty open cells for which `within` is not 0 (nullptr: all; nx*ny*nz values), from the lowest layer
  // up; in the last layer cells are drawn by lot. Returns the number of units without room.
  long fill(long units, const std::uint8_t *within, std::uint64_t when);

  long total() const;          // units in all cells
  long count_solid() const;    // solid cells, without the rim

  // To be called after writing to `cells` from outside: to content only (cheap), or to anything.
  void poured();
  void touched();

  void use(const Threads &now) { threads = now; }    // the cells are the same for any number of them

 private:
  friend struct AutomatonProbe;    // for tests

  // Knowledge of a layer: if a horizontal step cannot change it, that lasts until liquid comes or goes.
  struct Layer {
    std::uint8_t holds;    // of its open cells; a bit too many does no harm but costs time
    bool known, moved;
  };

  // A block with one or two solid cells; open cells as bits in ring order.
  struct Broken {
    std::uint32_t place, block;
    std::uint8_t open;
  };

  // The 2x2 blocks of a horizontal step. They start at `first` along x and y.
  struct Blocks {
    int first, nx, ny;
    std::vector<std::vector<Broken>> broken;    // of each layer, in any order
    std::vector<int> slot;                      // of each block in that list, or -1
    std::uint64_t key = 0;
    std::vector<std::uint16_t> draws;    // for the present group of layers: 8 layers, then the other 8

    int block(int bx, int by) const { return by * nx + bx; }
    std::uint32_t word(int block, int z) const;
  };

  // Rows of blocks, the same ones of every layer: the part that a thread sweeps, and its knowledge of layers.
  struct Band {
    Blocks &blocks;
    int first, last;    // [first, last)
    Layer *layers;
    int group = -1;    // of layers, whose draws are present
  };

  Blocks make_blocks(int first) const;
  void sort_block(Blocks &blocks, int bx, int by, int z);
  void look(int z);
  static bool mixes(const Layer &layer);
  static bool exchanges(const Layer &lower, const Layer &upper);
  double cost_of_sweep() const;
  void horizontal(Band &band, int z);
  void vertical_pair(Band &band, int z);
  void sweep_in_bands();
  template <class Sweep> void each_band(Blocks &blocks, const Sweep &sweep);

  struct Spill;
  bool expel(const Spill &spill, std::uint64_t key, std::vector<Spill> &arrived);

  std::uint64_t seed;
  Vertical vertical;
  Blocks even, odd;
  std::vector<Layer> layers;
  Threads threads;
};

}    // namespace mdanim
