// SPDX-License-Identifier: GPL-2.0-only
// A liquid with momentum: spans of columns that hold whole units, joined by links with velocities. docs/physics-liquid.md,
// "Waves". The cell, g and the density of the liquid are 1, so times are in sqrt(cell/g).

#pragma once

#include "liquid/cell_box.h"
#include "liquid/waves/wave_columns.h"
#include "liquid/waves/wave_exchange.h"
#include "liquid/waves/wave_loops.h"
#include "liquid/waves/wave_mouths.h"
#include "liquid/waves/wave_solids.h"
#include "liquid/waves/wave_stepper.h"
#include "liquid/waves/wave_walls.h"
#include "numbers/vec3.h"

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace mdanim {

// Every unit that leaves a span enters another one, so the sum never changes. Results depend on nothing but what is put in:
// neither on the instruction set nor on the way in which solids came to where they are.
class Waves {
 public:
  // Throws std::bad_alloc.
  Waves(int nx, int ny, int nz);

  // Sets the solid parts of all cells, as in SolidParts, and for each column the mass of floating bodies in it, in cells of
  // liquid, 0 where they are held (null: everywhere). Liquid makes way. Throws std::runtime_error when there is no room for it;
  // the waves cannot be used any more after that. `again`: the part of the change that will come once more in the next update.
  // Outside of a box `where` (null: the whole basin) nothing has changed.
  void set_solids(const std::uint16_t *part, const double *mass, double again = 1.0, const CellBox *where = nullptr)
  {
    cut.set_solids(part, mass, again, where);
    mouths.find_links();
  }
  // Sets the held part of each cell, as in SolidParts: a wall, like the sides of the basin. Plates at such walls cut columns when
  // solids are set next.
  void set_walls(const std::uint16_t *held)
  {
    cut.set_walls(held);
    walls.list_faces();
    mouths.list();
  }
  const SolidParts &solids() const { return columns.solid; }
  // Fills all spans of each column up to a height; full spans get the pressure of that height. `from`: leaves out liquid below
  // this height. `hollow`: leaves out these spans.
  void pour(const double *height, const double *from = nullptr, const std::vector<std::uint8_t> &hollow = {});
  // Spans, by their places, that are dry at the start although they begin below a level: floating bodies enclose them, alone or
  // with others that they are open to below that level. `floats` says of a cell that is not open whether it is a part of a
  // floating body.
  std::vector<std::uint8_t> hollows(double level, const std::function<bool(int column, int z)> &floats) const
  { return cut.hollows(level, floats); }
  // Returns the time by which the liquid has advanced. `share` is the part, now, of the motion that solids still have to make.
  double update(double dt, double share = 1.0);

  Units total() const;
  // Energy of height, and of motion along the links.
  struct Energy {
    double height, motion;
  };
  Energy energy() const;
  Vec3 momentum() const;    // along the links
  // Momentum that the liquid has lost to walls and to friction since the last call; and momentum that has come and gone with
  // give() and take().
  Vec3 take_lost() { return std::exchange(run.lost, Vec3{}); }
  Vec3 take_came() { return std::exchange(run.came, Vec3{}); }
  // Momentum, as seen in the basin, that liquid has lost because the basin gained speed.
  Vec3 take_left_behind() { return std::exchange(run.left_behind, Vec3{}); }
  // Work against the tilt by which that acts.
  double take_climbed() { return std::exchange(run.climbed, 0.0); }
  // Energy by which liquid that came and went has changed energy() since the last call.
  double take_brought() { return std::exchange(run.brought, 0.0); }

  // Everything that later updates depend on, as it is between updates.
  std::vector<std::uint8_t> state() const;
  // Sets the state. Throws std::runtime_error, and changes nothing, when it is damaged or not of such a basin.
  void set_state(const std::uint8_t *bytes, std::size_t size);

  // Sets how the acceleration of a basin that moves acts: heads rise by this from a column to the next.
  void tilt(double along_x, double along_y)
  {
    run.is_moved = true, run.resting = false;
    run.law.tilt[0] = along_x, run.law.tilt[1] = along_y;
  }
  bool at_rest() const { return run.resting; }                // nothing will move before a solid does
  void use(const Threads &now) { run.threads = now; }         // for updates; the bits are the same for any number of them
  void use(const WaveKernels &now) { run.kernels = &now; }    // those of any set of instructions give the same bits

  WaveRun run;

 private:
  friend struct WavesProbe;    // for tests
  using LinkPlace = WaveColumns::LinkPlace;

  WaveColumns columns;

 public:
  WaveExchange exchange;

 private:
  WaveSolids cut;
  WaveWalls walls;
  WaveMouths mouths;
  WaveStepper stepper;
};

}    // namespace mdanim
