// SPDX-License-Identifier: GPL-2.0-only
// Levelling of connected liquid, fast and in whole units, as in communicating vessels. It is an addition to the paper's rules,
// see docs/physics-liquid.md.

#pragma once

#include "liquid/automaton/cells.h"
#include "liquid/automaton/components.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace mdanim {

// The level rule and the heights of columns, on bodies of connected liquid (components.h). Buffers are kept from call to call.
class Leveller {
 public:
  // In each body of liquid (components.h), moves units from the highest exposed cells (first of all excess, q > 1) to the lowest
  // cells beside the body, by lot within a layer, while these are at least one layer lower (excess: wherever there is room); at
  // most max(1, ceil(rate * exposed cells), at_least) per body. Exposed cells and cells beside are those before the call; a cell
  // beside two bodies goes to the first in order that has a unit for it. Returns the number of units moved.
  long move(Cells &cells, std::uint64_t seed, std::uint64_t when, double rate, long at_least);

  // Height of the liquid in every column, in cells above the floor, x fastest, shape (ny, nx): of its topmost
  // solid cell (or the floor) and the units above that, as if packed; 0 where dry. In a body that is level
  // all columns that end in an exposed cell get one height, the exact mean of those that stand on liquid: z +
  // full / (full + part), see Body. So heights over open ground sum to the volume. NaN where a column has
  // no height: the cell above its topmost liquid is solid; it is dry and holds solid cells; or its topmost
  // liquid is a drop in the air or a film on a solid (no exposed cell of that body stands on liquid or on the
  // floor). `just_moved`: the cells are as the last `move` left them, which saves the search if that moved
  // nothing. Returns whether all liquid is level.
  bool heights(const Cells &cells, double *height, bool just_moved = false);

 private:
  struct Item {    // a cell that may give or take
    int body, z;
    std::uint32_t number, place;    // Cells::number, Cells::at
  };
  // Items body by body, in each in the order in which they were added.
  struct Groups {
    std::vector<Item> added, items;
    std::vector<std::size_t> start;
    void group(std::size_t bodies);
    Item *begin(std::size_t body) { return items.data() + start[body]; }
    Item *end(std::size_t body) { return items.data() + start[body + 1]; }
  };

  void collect(const Cells &cells);
  long move_in(std::size_t body, Cells &cells, std::uint64_t key, long most);
  void draw_lots(Item *from, Item *to, long count, std::uint64_t key);
  void pile_up(const Cells &cells, int y, double *height);
  void forget_solid(const Cells &cells, int y, Bodies::Word *dry, double *height);

  Bodies bodies;
  bool joined = false;       // bodies.join() was called for the last search
  bool unchanged = false;    // the last move moved nothing
  Groups excess, sources, targets;
  std::vector<std::pair<std::uint64_t, Item>> lots;
  std::vector<Bodies::Word> undecided;
  std::vector<std::uint8_t> holds_solid;
  std::vector<std::int32_t> ends, bed, pile;    // of a row's columns
};

}    // namespace mdanim
