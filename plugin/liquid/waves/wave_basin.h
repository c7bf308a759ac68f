// SPDX-License-Identifier: GPL-2.0-only
// The liquid with momentum in its basin. docs/physics-liquid.md, "Waves".

#pragma once

#include "liquid/basin.h"
#include "liquid/waves/drops.h"
#include "liquid/waves/wave_makers.h"
#include "liquid/waves/wave_push.h"
#include "liquid/waves/waves.h"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace mdanim {

// Waves, the cells that solids fill, and the push of each on the other. The unit of time of the waves is sqrt(cell/g).
class WaveBasin : public Basin {
 public:
  // Empty when such a basin is possible, else the reason why not.
  static std::string unusable(const Shape &shape);

  // `calm` [1/time] is a rate at which waves decay in addition, `spray` the share of drops, see Drops. Throws std::bad_alloc.
  // `ranks` must outlive the basin.
  WaveBasin(const Shape &shape, double g, double calm, double spray, std::uint64_t seed, const RankSums &ranks);

  // Makers of waves, to be added before the first update; lengths, times and volumes in units of the world. Sides are those of
  // WaveMakers.
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
    threads = now;
    waves.use(threads);
  }

  bool acts_on_cells() const override { return true; }
  OnParts on_parts(const Vec3 &middle) const override;
  double rising_at(const Vec3 &place) const override;
  double all_below() const override { return -std::numeric_limits<double>::infinity(); }
  double calms_solids() const override;
  void take_impulse(const Vec3 &place, const Vec3 &impulse) override;
  void take_push(const Vec3 &volume_along) override;

  bool is_smooth() const override { return true; }
  int top() const override { return top_layer; }
  bool is_poured() const override { return poured; }
  bool is_calm() const override { return sleeps() && !stale; }
  long moving_solid() const override { return moving; }
  long solid_cells() const override;
  double cells_now() const override { return static_cast<double>(waves.total() + drops.total()) / UNITS_PER_CELL; }
  double cells_at_start() const override { return static_cast<double>(units + makers.in() - makers.out()) / UNITS_PER_CELL; }
  std::int64_t updates_so_far() const override { return updates; }
  double clock(std::int64_t step, double dt) const override
  { return gone + slept + wait.time() + static_cast<double>(wait.since_look(step, pace.every)) * dt; }
  double energy() const override { return energy_now() - energy_at_start; }
  Vec3 momentum() const override { return in_world(waves.momentum() + drops.momentum()); }
  Impulses impulses() const override { return {in_world(account.basin), in_world(account.solids), in_world(account.came)}; }
  double highest() const override { return crest; }
  double bytes() const override;
  double mean_level() const override;
  void surface(double *smooth, double *raw) const override;
  double smooth_height(int column) const override;
  double raw_height(int column) const override { return shape.low.z + tops[column] * shape.cell.z; }
  std::vector<Droplet> droplets() const override;
  void contents(std::uint8_t *out) const override;
  std::vector<std::uint8_t> state(const Ledger &ledger) const override;
  Ledger set_state(const std::uint8_t *bytes, std::size_t size) override;

 private:
  double energy_now() const;
  Vec3 in_world(const Vec3 &momentum) const;
  bool sleeps() const { return waves.at_rest() && makers.none() && drops.all().empty(); }
  void give_impulses(double since, double asleep);
  void go_on(double time, int parts, int n);
  void set_walls();
  void count_parts();
  std::size_t part_number(int column, int z) const { return static_cast<std::size_t>(column) * shape.nz + z; }
  void look();
  void find_push(double part, double since);
  void look_at_column(int column);

  const RankSums &ranks;
  Threads threads;
  const double unit_of_time;
  Waves waves;
  WavePush push;
  WaveMakers makers;
  Drops drops;
  Occupancy still, mobile;
  CellBox marked, changed;            // cells outside are open; the cells that the waves know
  std::vector<std::uint16_t> part;    // solid part of each cell, see SolidParts
  std::vector<double> mass;           // of floating bodies in each column, in cells of liquid, as given to the liquid
  std::vector<AddedMass::Solids> afloat;
  struct Rising {
    double there = 0.0, velocity = 0.0;    // 1 where there are solids; upward velocity, over speed_of_waves()
  };
  std::vector<Rising> rising;

  // state
  bool poured = false, stale = false;    // stale: solids have changed that the liquid does not know of
  double travel = 0.0;                   // distance of the fastest particle near the liquid since the last update, in cells
  Wait wait;
  double gone = 0.0, slept = 0.0;    // [time] that the liquid has advanced in updates, and that it has left out at rest
  std::int64_t updates = 0;
  Units units = 0;    // of liquid at the start
  double energy_at_start = 0.0;
  Impulses account;                 // in units of the waves
  long moving = 0;                  // cells with moving solids
  std::uint64_t still_known = 0;    // a checksum of the solids that never move

  // derived from the state
  static constexpr std::uint64_t NOTHING_STILL = 1469598103934665603ULL;    // the checksum without such solids
  std::uint64_t walled_for = NOTHING_STILL;    // the checksum for which the waves have set their walls
  // From solids, none between updates: for each column along x, then along y; then the push on solids along x and y.
  std::vector<std::int64_t> from_solids;
  std::vector<double> heads, tops;     // for each column: the surface that acts on solids, and the topmost liquid, see surface()
  std::vector<std::uint8_t> hollow;    // columns that a hull keeps dry below the surface
  int top_layer = 0;
  double crest = 0.0;    // the highest head under open sky
};

}    // namespace mdanim
