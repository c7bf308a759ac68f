// SPDX-License-Identifier: GPL-2.0-only
// The liquid with momentum in its basin. docs/physics-liquid.md, "Waves".

#pragma once

#include "liquid/basin.h"
#include "liquid/waves/drops.h"
#include "liquid/waves/solid_columns.h"
#include "liquid/waves/solid_impulses.h"
#include "liquid/waves/wave_heights.h"
#include "liquid/waves/wave_makers.h"
#include "liquid/waves/wave_push.h"
#include "liquid/waves/waves.h"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace mdanim {

// Numbers that the command has for waves.
struct WaveSettings {
  double calm = 0.0;       // rate at which waves decay in addition [1/time]
  double manning = 0.0;    // Manning's n of the ground [time/length^(1/3)]
  double spray = 0.0;      // the share of drops, see Drops
  std::uint64_t seed = 1;
};

// Waves, the cells that solids fill, and the push of each on the other. The unit of time of the waves is sqrt(cell/g).
class WaveBasin : public Basin {
 public:
  // Empty when such a basin is possible, else the reason why not.
  static std::string unusable(const Shape &shape);

  // Throws std::bad_alloc. `ranks` must outlive the basin.
  WaveBasin(const Shape &shape, double g, const WaveSettings &settings, const RankSums &ranks);

  // Makers of waves, to be added before the first update; lengths, times and volumes in units of the world. Sides as SideOf.
  void add_wave(int side, double amplitude, double period, double depth);
  void add_current(int side, double speed);
  // Liquid comes in with a velocity, or goes out where `rate` [volume/time] is negative: in columns whose middle lies between the
  // corners, at least one, at the height of the middle. Velocities are limited to fastest() along x or y [distance/time].
  double fastest(int axis) const { return waves.run.law.fastest * (axis == 0 ? shape.cell.x : shape.cell.y) / unit_of_time; }
  void add_flow(const Vec3 &low, const Vec3 &high, double rate, double ux, double uy);

  long mark_still(const AddBodies &bodies) override;
  void mark_moving(const AddBodies &bodies) override;
  Filled fill(const Amount &amount, const std::vector<std::uint8_t> &within, std::uint64_t when) override;
  void settle(std::uint64_t) override { stale = true; }
  bool is_due(double fastest, double dt, std::int64_t step) override;
  void update(const AddBodies &bodies, std::uint64_t when) override;
  void use(const Threads &now) override
  {
    Basin::use(now);
    waves.use(threads);
  }

  bool can_move() const override { return true; }
  void accelerate(const Vec3 &mean) override;

  bool acts_on_cells() const override { return true; }
  OnParts on_parts(const Vec3 &middle) const override;
  double rising_at(const Vec3 &place) const override;
  double all_below() const override { return -std::numeric_limits<double>::infinity(); }
  double calms_solids() const override;
  void take_impulse(const Vec3 &place, const Vec3 &impulse) override { from_solids.take(place, impulse); }
  void take_push(const Vec3 &volume_along) override { from_solids.take_push(volume_along); }

  bool is_smooth() const override { return true; }
  int top() const override { return heights.top_layer(); }
  bool is_calm() const override { return sleeps() && !stale; }
  long moving_solid() const override { return solids.now().moving; }
  long solid_cells() const override { return solids.solid_cells(); }
  double cells_now() const override { return static_cast<double>(waves.total() + drops.total()) / UNITS_PER_CELL; }
  double cells_at_start() const override { return static_cast<double>(units + makers.in() - makers.out()) / UNITS_PER_CELL; }
  std::int64_t updates_so_far() const override { return updates; }
  double clock(std::int64_t step, double dt) const override
  { return gone + slept + wait.time() + static_cast<double>(wait.since_look(step, pace.every)) * dt; }
  double energy() const override { return energy_now() - energy_at_start; }
  Vec3 momentum() const override { return in_world(waves.momentum() + drops.momentum()); }
  Impulses impulses() const override
  { return {in_world(account.basin), in_world(account.solids), in_world(account.came), account.outer}; }
  double highest() const override { return heights.crest(); }
  double bytes() const override;
  double mean_level() const override { return mean_of(heights.all_heads()); }
  void surface(double *smooth, double *raw) const override;
  double smooth_height(int column) const override;
  double raw_height(int column) const override { return shape.low.z + heights.top(column) * shape.cell.z; }
  std::vector<Droplet> droplets() const override;
  void contents(std::uint8_t *out) const override;
  std::vector<std::uint8_t> state(const Ledger &ledger) const override;
  Ledger set_state(const std::uint8_t *bytes, std::size_t size) override;

 private:
  double energy_now() const;
  Vec3 in_world(const Vec3 &momentum) const;
  bool sleeps() const { return waves.at_rest() && !waves.run.is_moved && makers.none() && drops.all().empty(); }
  void give_impulses(double since, double asleep);
  void go_on(double time, int parts, int n);
  void find_heights();
  void find_push(double part, double since);

  const double unit_of_time;
  Waves waves;
  SolidColumns solids;
  SolidImpulses from_solids;    // none between updates
  WavePush push;
  WaveMakers makers;
  Drops drops;
  WaveHeights heights;
  struct Rising {
    double there = 0.0, velocity = 0.0;    // 1 where there are solids; upward velocity, over speed_of_waves()
  };
  std::vector<Rising> rising;

  // state
  bool stale = false;                // solids have changed that the liquid does not know of
  double gone = 0.0, slept = 0.0;    // [time] that the liquid has advanced in updates, and that it has left out at rest
  std::int64_t updates = 0;
  Units units = 0;    // of liquid at the start
  double energy_at_start = 0.0;
  Impulses account;    // in units of the waves, but for work
};

}    // namespace mdanim
