// SPDX-License-Identifier: GPL-2.0-only
// Makers of waves and currents: liquid that comes in and goes out, exact to the unit. docs/physics-liquid.md, "Makers of waves".

#pragma once

#include "liquid/waves/columns.h"
#include "liquid/waves/span.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mdanim {

class Waves;

// At any time waves.total() is its value at the start, plus in(), minus out(), apart from liquid that flies. Lengths are in
// cells, times in sqrt(cell/g).
class WaveMakers {
 public:
  // Columns [low, high) along x and y, and the height at which liquid comes and goes: that of the span that holds it, or else of
  // the next one below.
  struct Mouth {
    int low[2], high[2];
    double height;
  };

  WaveMakers(int nx, int ny) : nx(nx), ny(ny) {}

  // `rate` in cells per time, for the whole mouth; liquid comes in with a velocity. Liquid that finds no room stays outside.
  void add_inflow(const Mouth &mouth, double rate, double ux, double uy);
  void add_drain(const Mouth &mouth, double rate);
  // A paddle along a side: waves of an amplitude and a period run from there into liquid of a depth. The paddle draws back the
  // liquid that it pushes in.
  void add_paddle(SideOf side, double amplitude, double period, double depth);
  // Liquid goes out at the opposite side and comes in at `from`, at a speed, as deep as it is where it goes out.
  void add_current(SideOf from, double speed);

  // To be called before an update of the waves.
  void apply(Waves &waves, double dt);

  bool none() const { return makers.empty(); }
  Units in() const { return account.in; }
  Units out() const { return account.out; }
  std::vector<std::uint8_t> state() const;
  // Sets a state of the same makers. Throws std::runtime_error, and changes nothing, when it is of others.
  void set_state(const std::uint8_t *bytes, std::size_t size);

 private:
  enum Kind { INFLOW, DRAIN, PADDLE, CURRENT };
  struct Maker {
    Kind kind;
    Mouth mouth, drain;           // mouth where liquid comes in; drain where a current goes out
    double rate, period, u[2];    // rate: cells per time in the whole mouth, of a paddle the largest
  };

  Mouth along(SideOf side) const;
  Units come(Waves &waves, const Mouth &mouth, Units units, double ux, double uy);
  Units go(Waves &waves, const Mouth &mouth, Units units);

  const int nx, ny;
  std::vector<Maker> makers;
  std::vector<double> due;    // of each maker: the part of a unit that is still due
  struct Account {
    double time = 0.0;
    Units in = 0, out = 0;
  } account;
};

}    // namespace mdanim
