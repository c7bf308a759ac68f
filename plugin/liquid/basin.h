// SPDX-License-Identifier: GPL-2.0-only
// A liquid in its basin, independent of the program that runs it: the common interface of all models of a liquid.

#pragma once

#include "buoyancy/immersed.h"
#include "liquid/occupancy.h"
#include "liquid/rank_sums.h"
#include "threads/team.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <vector>

namespace mdanim {

// Cells of liquid, the cells that solids fill, the forces on solids, and the times at which all of this is updated. Solids are
// given as counts of samples, summed over ranks by RankSums. Every rank holds the whole basin. Places and heights are in cells
// from its lower corner unless units of distance are mentioned.
class Basin {
 public:
  struct Shape {
    int nx, ny, nz;
    Vec3 low, cell;    // corner, and edges of a cell
  };
  struct Pace {
    int sweeps = 0;          // of the automaton, per update; 0 chooses by the travel of solids
    int every = 4;           // steps between checks whether an update is due
    double stride = 0.25;    // travel of solids between updates, in cells
    double period = 0.06;    // between updates while the liquid is not level, in sqrt(cell/g)
  };
  // Time since the last update, by the steps between checks.
  struct Wait {
    double before = 0.0;       // [time] in steps of another length
    std::int64_t steps = 0;    // of dt, since `before`
    double dt = 0.0;
    std::int64_t looked = 0;    // step of the last check
    // A check at a multiple of `every`, which may differ from the number at the last check; steps may be numbered anew. Returns
    // the steps since then.
    std::int64_t look(std::int64_t step, int every, double now)
    {
      if (now != dt) {
        before = time();
        steps = 0;
        dt = now;
      }
      const std::int64_t more = since_look(step, every);
      steps += more;
      looked = step;
      return more;
    }
    std::int64_t since_look(std::int64_t step, int every) const
    {
      const std::int64_t gone = step - looked, in_turn = step % every;
      return gone >= 0 && gone <= every ? gone : in_turn ? in_turn : every;
    }
    double time() const { return before + static_cast<double>(steps) * dt; }
    void end()
    {
      before = 0.0;
      steps = 0;
    }
  };
  struct Energies {
    double work = 0.0, lost = 0.0;    // energy from all forces of the liquid on solids except drag; energy lost to drag
  };
  // The fix's part of the state. Powers cannot be computed again: solids are calmed by their velocities of half steps.
  struct Ledger {
    Energies sum, power;    // until now; at the last step, per time
  };
  struct Amount {
    bool by_level;
    double value;         // height [distance] or volume [distance^3]
    bool into_hollows;    // also into spaces that enclose air at the start (Waves::hollows)
  };
  // Whole cells of liquid that were wanted, and those without room.
  struct Filled {
    std::int64_t wanted;
    long left;
  };
  // Impulses so far, sideways, over density [volume * velocity]: on the basin and on held solids in it, friction of the liquid
  // among them; on solids that move; and the momentum that came with liquid, less that which left with it.
  struct Impulses {
    Vec3 basin, solids, came;
    double outer = 0.0;    // energy from outside, over density: of liquid that came and went, and in the frame of a basin that
                           // moves the work of its acceleration
  };
  // A drop of liquid that flies.
  struct Droplet {
    Vec3 place;    // [distance], as the radius
    double radius;
  };
  using AtPlace = mdanim::AtPlace<double>;
  // The action of the liquid on the eight parts of a lattice cell, each nearest to one of its corners. s is the fraction of such
  // a part below the surface: surface - z, z that of the corner [cells], within 0 and 1, times share.
  struct OnParts {
    double surface = 0.0, share = 0.0;
    double more = 0.0, beside = 0.0;        // the push upwards is s + more; the surface around makes it s + beside
    double along_x = 0.0, along_y = 0.0;    // push sideways, times s + beside where that is positive
    double flow_x = 0.0, flow_y = 0.0;      // velocity of the liquid [distance/time]
    double part_below(double z) const { return std::clamp(surface - z, 0.0, 1.0) * share; }
  };
  // Adds this rank's bodies as far as they are below a height.
  using AddBodies = std::function<void(Occupancy &, double below)>;

  static constexpr int MOST_SWEEPS = 4096;    // per update; also separates the keys of their random numbers
  // Key of the random numbers of part `part` of an update, for parts that come several times; the first has the key of the step.
  static constexpr std::uint64_t key_of(std::uint64_t step, int part) { return step + (static_cast<std::uint64_t>(part) << 40); }

  static constexpr double NEAR = 8.0;    // cells above the liquid up to which the motion of solids counts

  // `ranks` must outlive the basin.
  Basin(const Shape &shape, double g, const RankSums &ranks)
      : shape(shape), g(g), shortest(std::min({shape.cell.x, shape.cell.y, shape.cell.z})),
        per_cell{1.0 / shape.cell.x, 1.0 / shape.cell.y, 1.0 / shape.cell.z}, ranks(ranks)
  {
  }
  virtual ~Basin() = default;

  // --- solids and time ---

  // Marks bodies that never move; returns the number of cells that this changes.
  virtual long mark_still(const AddBodies &bodies) = 0;
  // Before liquid is poured: marks bodies that may move.
  virtual void mark_moving(const AddBodies &bodies) = 0;
  // The start: pours liquid into open cells where `within`, of all cells, is not 0, from the lowest up.
  virtual Filled fill(const Amount &amount, const std::vector<std::uint8_t> &within, std::uint64_t when) = 0;
  // To be called after bodies that never move have been moved. Throws std::runtime_error when liquid has no room left, as
  // update().
  virtual void settle(std::uint64_t when) = 0;
  // Whether an update is due at this step; called every pace.every steps of dt. `fastest` is the square of the speed of the
  // fastest solid near the liquid, or negative when there is none. Depends only on the state, so that neither ranks nor pieces of
  // a run change it.
  virtual bool is_due(double fastest, double dt, std::int64_t step) = 0;
  virtual void update(const AddBodies &bodies, std::uint64_t when) = 0;
  virtual void use(const Threads &now) { threads = now; }    // for updates

  // --- what acts on solids, and they on the liquid ---

  // Fraction of a volume at a place that is below the surface; only Archimedes' lift acts on it.
  virtual double part_below(const Vec3 & /*place*/) const { return 0.0; }
  // Whether on_parts() is to be called after each update, instead of part_below() in each step, and solids report their action on
  // the liquid.
  virtual bool acts_on_cells() const { return false; }
  // Action on a lattice cell with its middle at a place; cells may come in any order.
  virtual OnParts on_parts(const Vec3 & /*middle*/) const { return {}; }
  // Upward velocity of the solid around a place [distance/time].
  virtual double rising_at(const Vec3 & /*place*/) const { return 0.0; }
  // From the returned height down, the whole basin is below the surface.
  virtual double all_below() const = 0;
  // Rate [1/time] at which immersed particles lose the velocity relative to the solid around them.
  virtual double calms_solids() const { return 0.0; }
  // Takes the impulse on the liquid since the last update, from a solid of this rank.
  virtual void take_impulse(const Vec3 & /*place*/, const Vec3 & /*impulse*/) {}
  // Takes the sideways push on such a solid in each step since then, over the weight of liquid of volume 1.
  virtual void take_push(const Vec3 & /*volume_along*/) {}

  // Whether the basin can be moved along x and y.
  virtual bool can_move() const { return false; }
  // To be called in each step of a basin that moves: where it is from its place at the start, and how fast it moves now.
  void move_to(const Vec3 &place, const Vec3 &velocity) { shift = place, speed = velocity; }
  const Vec3 &velocity() const { return speed; }
  // To be called before an update: its mean acceleration [distance/time^2] since the last one, this time [time] ago.
  virtual void accelerate(const Vec3 & /*mean*/) {}
  double since_update() const { return wait.time(); }

  const Vec3 &way() const { return shift; }
  Vec3 low() const { return shape.low + shift; }    // its corner now
  Vec3 in_cells(const double *x) const
  { return {(x[0] - low().x) * per_cell.x, (x[1] - low().y) * per_cell.y, (x[2] - low().z) * per_cell.z}; }
  double height(double cells) const { return shape.low.z + cells * shape.cell.z; }    // [distance]
  // Whether x [distance] is over the basin's floor.
  bool over_floor(const double *x) const
  {
    return x[0] >= low().x && x[0] <= low().x + shape.nx * shape.cell.x && x[1] >= low().y &&
           x[1] <= low().y + shape.ny * shape.cell.y;
  }
  // Number of a cell.
  std::size_t cell_number(int x, int y, int z) const { return (static_cast<std::size_t>(z) * shape.ny + y) * shape.nx + x; }

  // --- output ---

  int columns() const { return shape.nx * shape.ny; }
  double speed_of_waves() const { return std::sqrt(g * shape.cell.z); }    // in liquid one cell deep [distance/time]
  double cell_volume() const { return shape.cell.x * shape.cell.y * shape.cell.z; }
  virtual bool is_smooth() const = 0;    // whether samples of bodies are spread, and columns know the mass in them
  virtual int top() const = 0;           // no liquid in layers from this one up
  bool is_poured() const { return poured; }
  virtual bool is_calm() const = 0;    // level, and no solid has moved since
  virtual long moving_solid() const = 0;
  virtual long solid_cells() const = 0;
  virtual double cells_now() const = 0;    // of liquid
  virtual double cells_at_start() const = 0;
  virtual std::int64_t updates_so_far() const = 0;    // sweeps of the automaton
  // Time [time] that a liquid with momentum has computed by this step, and the time that it has slept at rest. The sum must be
  // the time of solids. 0 for other liquids.
  virtual double clock(std::int64_t /*step*/, double /*dt*/) const { return 0.0; }
  virtual double energy() const { return 0.0; }    // of the liquid since the start, over density g cell^4; 0 without momentum
  virtual Vec3 momentum() const { return {}; }     // of the liquid, over density [volume * velocity]; sideways
  virtual Impulses impulses() const { return {}; }
  virtual double highest() const { return top(); }    // of all liquid
  virtual double bytes() const = 0;
  virtual double mean_level() const = 0;    // [distance]
  // Heights [distance] of all columns, x fastest: the surface that acts on solids, and the topmost liquid: NaN where a body hides
  // it, minus infinity where a hull keeps the column dry.
  virtual void surface(double *smooth, double *raw) const = 0;
  virtual double smooth_height(int column) const = 0;    // the same of one column, but dry ones that a hull hides have no height
  virtual double raw_height(int column) const = 0;
  // Droplets in the order in which they left the liquid.
  virtual std::vector<Droplet> droplets() const { return {}; }
  // Content of each cell, 255 where it is solid; x fastest, then y.
  virtual void contents(std::uint8_t *out) const = 0;

  // Everything that later steps depend on, except positions and velocities, and the ledger.
  virtual std::vector<std::uint8_t> state(const Ledger &ledger) const = 0;
  // Sets the state. Throws std::runtime_error, and changes nothing, when it is damaged or not of such a basin.
  virtual Ledger set_state(const std::uint8_t *bytes, std::size_t size) = 0;

  const Shape shape;
  const double g;           // [distance/time^2]
  const double shortest;    // of a cell's edges
  const Vec3 per_cell;      // cells per distance
  Pace pace;
  double liquid_seconds = 0.0, occupancy_seconds = 0.0;

 protected:
  // Mean [distance] of heights of all columns [cells].
  double mean_of(const std::vector<double> &heights) const
  { return shape.low.z + shape.cell.z * std::accumulate(heights.begin(), heights.end(), 0.0) / columns(); }

  const RankSums &ranks;
  Threads threads;
  Vec3 shift, speed;    // [distance], [distance/time]; functions of the step, not a state
  // state
  bool poured = false;
  double travel = 0.0;    // distance of the fastest particle near the liquid since the last update, in cells
  Wait wait;
};

}    // namespace mdanim
