// SPDX-License-Identifier: GPL-2.0-only
// The liquid in its basin, apart from the program that runs it. Wcislo 1999, sec. 4; docs/physics-liquid.md.

#ifndef MDANIM_BASIN_H
#define MDANIM_BASIN_H

#include "laws/buoyancy.h"
#include "laws/vec3.h"
#include "liquid/automaton.h"
#include "liquid/level.h"
#include "liquid/solid_cells.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace mdanim {

// Cells of liquid that the automaton and the level rule move, the cells that solids fill, the smooth surface, and when all of
// this is brought up to date. Solids come in as counts of samples, sums over ranks by RankSums. Every rank holds
// the whole basin. Places and heights are in cells from its lower corner unless they are said to be in units of distance.
class Basin {
 public:
  enum class Model { SURFACE, PAPER };    // what immerses a particle: the height of the surface, or liquid in the cells around
  struct Shape {
    int nx, ny, nz;
    Vec3 low, cell;    // corner, and edges of a cell
  };
  struct Pace {
    int sweeps = 0;          // per update; 0 chooses by how far solids have travelled
    int every = 4;           // steps between looks whether an update is due
    double stride = 0.25;    // that solids travel between updates, in cells
    double period = 0.06;    // between updates while the liquid is not level, in sqrt(cell/g)
  };
  struct Energies {
    double work = 0.0, lost = 0.0;    // of lift, to drag; the state holds them for the fix
  };
  // Adds this rank's bodies, as far as they reach below a height.
  using AddBodies = std::function<void(Occupancy &, double below)>;

  static constexpr int MOST_SWEEPS = 4096;    // per update; also parts the keys of their random numbers
  static constexpr double NEAR = 8.0;         // cells above the liquid up to which the motion of solids counts

  // Empty when a grid can be numbered and its state be kept, else why not.
  static std::string too_large(int nx, int ny, int nz);

  // Throws std::bad_alloc. `ranks` stays where it is.
  Basin(const Shape &shape, double g, std::uint64_t seed, Vertical vertical, Model model, const RankSums &ranks);

  // --- solids and time ---

  // Marks what never moves; returns how many cells that changes.
  long mark_still(const AddBodies &bodies);
  // Before liquid is poured: marks what moves.
  void mark_moving(const AddBodies &bodies);
  // Units that fill a basin up to a height [distance] where `within` is not 0, and those of a volume [distance^3].
  std::int64_t units_up_to(double height, const std::vector<std::uint8_t> &within) const;
  std::int64_t units_of(double volume) const;
  // The start: liquid into open cells where `within` is not 0, from the lowest up. Returns how many units find no room.
  long pour(std::int64_t units, const std::vector<std::uint8_t> &within, std::uint64_t when);
  // What never moves has been moved. Throws std::runtime_error when liquid has no room left, as update().
  void settle(std::uint64_t when);
  // Whether an update is due, `every` steps of dt after this was asked last. `fastest` is the square of the speed of the fastest
  // solid near the liquid, or negative when there is none. Depends on the state alone, so that neither ranks nor pieces of a
  // run change it.
  bool is_due(double fastest, double dt);
  void update(const AddBodies &bodies, std::uint64_t when, double dt);

  // --- what acts on solids ---

  Vec3 in_cells(const double *x) const
  { return {(x[0] - shape.low.x) / shape.cell.x, (x[1] - shape.low.y) / shape.cell.y, (x[2] - shape.low.z) / shape.cell.z}; }
  // Whether x [distance] is over the basin's floor.
  bool over_floor(const double *x) const
  {
    return x[0] >= shape.low.x && x[0] <= shape.low.x + shape.nx * shape.cell.x && x[1] >= shape.low.y &&
           x[1] <= shape.low.y + shape.ny * shape.cell.y;
  }
  // Part of the volume around a particle that counts as immersed.
  double immersed(const Vec3 &place) const
  {
    if (!(place.x >= 0.0 && place.x <= shape.nx && place.y >= 0.0 && place.y <= shape.ny)) return 0.0;
    return model == Model::SURFACE ? immersed_part(surface_at(place), place.z) : liquid_around(place);
  }
  double surface_at(const Vec3 &place) const
  { return at_point(eta.data(), blocked.data(), shape.nx, shape.ny, place.x, place.y); }
  // Whether a face of a solid at x [distance] below the surface has air before it all the same, as the inside of a hull does: no
  // liquid in the first open cell along its normal, of length 1, and none above that.
  bool air_before(const Vec3 &x, const Vec3 &normal) const;

  // --- output ---

  const Cells &cells() const { return automaton.cells; }
  int columns() const { return shape.nx * shape.ny; }
  int top() const { return top_layer; }    // no liquid in layers from this one up
  double lowest_surface() const { return lowest_eta; }
  bool is_poured() const { return poured; }
  bool is_calm() const { return calm; }    // level, and no solid has moved since
  long moving_solid() const { return solid.moving(); }
  long solid_cells() const { return automaton.count_solid(); }
  std::int64_t units_now() const { return automaton.total(); }
  std::int64_t units_at_start() const { return units; }
  std::int64_t sweeps_so_far() const { return swept; }
  double bytes() const;
  // Height [distance] of the surface, the mean and over a column, and of the column's topmost liquid (NaN where it has none).
  double mean_level() const;
  double smooth_height(int column) const { return shape.low.z + eta[column] * shape.cell.z; }
  double raw_height(int column) const { return shape.low.z + height[column] * shape.cell.z; }
  // Both for all columns, x fastest; the second is minus infinity where a hull keeps a column dry.
  void surface(double *smooth, double *raw) const;
  // Content of each cell, 255 where it is solid; x fastest, then y.
  void contents(std::uint8_t *out) const;

  // Everything that later steps depend on, except positions and velocities, and the energies.
  std::vector<std::uint8_t> state(const Energies &energies) const;
  // Takes it up. Throws std::runtime_error, and changes nothing, when it is not of such a basin or damaged.
  Energies set_state(const std::uint8_t *bytes, std::size_t size);

  const Shape shape;
  const Model model;
  const double g;
  const double shortest;    // of a cell's edges
  Pace pace;
  double automaton_seconds = 0.0, occupancy_seconds = 0.0;

 private:
  long make_room(std::uint64_t when);
  void flow(long changed, std::uint64_t when, double dt);
  void raise_surface(bool just_levelled);
  void smooth();
  bool is_parted(int x, int y) const;
  double shut_in_height() const;
  double liquid_around(const Vec3 &place) const;

  const RankSums &ranks;
  const std::uint64_t seed;
  Automaton automaton;
  Leveller leveller;
  SolidCells solid;

  // state
  bool poured = false;
  bool calm = false;
  double crossed = 0.0;               // by a shallow-water wave since liquid was last levelled
  double travel = 0.0;                // of the fastest particle near the liquid since the last update
  std::int64_t waited = 0;            // steps since the last update
  std::int64_t swept = 0;             // sweeps so far
  std::int64_t units = 0;             // of liquid at the start
  std::vector<double> height, eta;    // of the columns; see level.h, surface.h

  // what follows from it
  std::vector<std::uint8_t> blocked;    // columns whose surface is parted by something still
  int top_layer = 0;
  double lowest_eta = 0.0;
};

}    // namespace mdanim

#endif
