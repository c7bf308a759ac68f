// SPDX-License-Identifier: GPL-2.0-only
// The liquid without momentum in its basin. Wcislo 1999, sec. 4; docs/physics-liquid.md.

#pragma once

#include "buoyancy/law.h"
#include "liquid/automaton/automaton.h"
#include "liquid/automaton/level.h"
#include "liquid/automaton/solid_cells.h"
#include "liquid/basin.h"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace mdanim {

// Cells of liquid that the automaton and the level rule move, and the smooth surface.
class AutomatonBasin : public Basin {
 public:
  enum class Immersion {
    SURFACE,
    PAPER
  };    // a particle is immersed by the height of the surface, or by liquid in the cells around

  // Empty when a grid can be numbered and its state can be stored, else the reason why not.
  static std::string too_large(int nx, int ny, int nz);

  // Throws std::bad_alloc. `ranks` must outlive the basin.
  AutomatonBasin(const Shape &shape, double g, std::uint64_t seed, Vertical vertical, Immersion immersion, const RankSums &ranks);

  long mark_still(const AddBodies &bodies) override;
  void mark_moving(const AddBodies &bodies) override;
  Filled fill(const Amount &amount, const std::vector<std::uint8_t> &within, std::uint64_t when) override;
  // Pours units into open cells where `within` is not 0; returns the number of units without room.
  long pour(std::int64_t units, const std::vector<std::uint8_t> &within, std::uint64_t when);
  void settle(std::uint64_t when) override;
  bool is_due(double fastest, double dt, std::int64_t step) override;
  void update(const AddBodies &bodies, std::uint64_t when) override;

  double part_below(const Vec3 &place) const override
  {
    if (!(place.x >= 0.0 && place.x <= shape.nx && place.y >= 0.0 && place.y <= shape.ny)) return 0.0;
    return immersion == Immersion::SURFACE ? immersed_part(surface_at(place), place.z) : liquid_around(place);
  }
  double all_below() const override
  {
    return immersion == Immersion::SURFACE && lowest_eta >= 1.0 ? shape.low.z + (lowest_eta - 0.5) * shape.cell.z
                                                                : -std::numeric_limits<double>::infinity();
  }

  bool is_smooth() const override { return false; }
  int top() const override { return top_layer; }
  bool is_calm() const override { return calm; }
  long moving_solid() const override { return solid.moving(); }
  long solid_cells() const override { return automaton.count_solid(); }
  double cells_now() const override { return static_cast<double>(automaton.total()); }
  double cells_at_start() const override { return static_cast<double>(units); }
  std::int64_t updates_so_far() const override { return swept; }
  double bytes() const override;
  double mean_level() const override { return mean_of(eta); }
  void surface(double *smooth, double *raw) const override;
  double smooth_height(int column) const override { return shape.low.z + eta[column] * shape.cell.z; }
  double raw_height(int column) const override { return shape.low.z + height[column] * shape.cell.z; }
  void contents(std::uint8_t *out) const override;
  std::vector<std::uint8_t> state(const Ledger &ledger) const override;
  Ledger set_state(const std::uint8_t *bytes, std::size_t size) override;

  const Cells &cells() const { return automaton.cells; }
  void use(const Threads &now) override
  {
    Basin::use(now);
    automaton.use(threads);
  }

 private:
  std::int64_t units_up_to(double height, const std::vector<std::uint8_t> &within) const;
  long make_room(std::uint64_t when);
  void flow(long changed, std::uint64_t when);
  void raise_surface(bool just_levelled);
  void smooth();
  bool is_parted(int x, int y) const;
  double shut_in_height() const;
  double liquid_around(const Vec3 &place) const;
  double surface_at(const Vec3 &place) const
  { return at_point(eta.data(), blocked.data(), shape.nx, shape.ny, place.x, place.y); }

  const Immersion immersion;
  const std::uint64_t seed;
  Automaton automaton;
  Leveller leveller;
  SolidCells solid;

  // state
  bool calm = false;
  double crossed = 0.0;               // distance of a shallow-water wave since liquid was last levelled
  std::int64_t swept = 0;             // sweeps so far
  std::int64_t units = 0;             // of liquid at the start
  std::vector<double> height, eta;    // of the columns; see level.h, surface.h

  // derived from the state
  std::vector<std::uint8_t> blocked;    // columns whose surface is parted by a still solid
  int top_layer = 0;
  double lowest_eta = 0.0;
};

}    // namespace mdanim
