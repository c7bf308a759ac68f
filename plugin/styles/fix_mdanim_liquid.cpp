// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/liquid: when the automaton steps, what it is told of solids and what solids feel of it; the
// rules are in automaton.h, level.h, surface.h, occupancy.h and buoyancy.h. Every rank holds the whole grid.

#include "styles/fix_mdanim_liquid.h"

#include "engine/stopwatch.h"
#include "laws/buoyancy.h"
#include "liquid/surface.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "neighbor.h"
#include "region.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <stdexcept>
#include <unordered_map>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static constexpr double STATE_VERSION = 2.0;

// Reasons and measurements: docs/physics-liquid.md.
static constexpr double SWEEPS_PER_CELL = 8.0;    // that the fastest solid travels
static constexpr int MOST_SWEEPS = 4096;          // per update; also parts the keys of their random numbers
static constexpr double LEVEL_RATE = 0.11;        // share of exposed cells moved while a shallow-water wave crosses one cell
static constexpr double SAMPLED = 4.0;            // cells above the liquid up to which solids are marked
static constexpr double NEAR = 8.0;               // cells above the liquid up to which their motion counts
static constexpr double SPLASH = 1.5;             // cells below the surface within which an empty cell is taken for a ripple
static constexpr std::uint8_t SOLID_CODE = 255, STILL_CODE = 254;

// --- the command ---

// fix ID group mdanim/liquid REGION rho grid NX NY NZ volume V | level Z gravity G keyword values ...
FixMdanimLiquid::FixMdanimLiquid(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  scalar_flag = 1;
  extscalar = 1;
  energy_global_flag = 1;
  vector_flag = 1;
  size_vector = 11;
  extvector = 0;
  array_flag = 1;
  size_array_cols = 4;
  extarray = 0;
  global_freq = 1;
  nevery = 1;
  restart_global = 1;

  if (narg < 9) utils::missing_cmd_args(FLERR, "fix mdanim/liquid", error);
  region_id = arg[3];
  Region *region = domain->get_region_by_id(region_id);
  if (!region) error->all(FLERR, 3, "fix mdanim/liquid: there is no region {}; make it before this fix", arg[3]);
  if (strcmp(region->style, "block") != 0 || !region->interior || region->dynamic_check() || !region->bboxflag)
    error->all(FLERR, 3, "fix mdanim/liquid: the basin must be a finite, resting region of style block, side in; {} is not",
               arg[3]);
  rho = utils::numeric(FLERR, arg[4], false, lmp);
  if (!(rho > 0.0)) error->all(FLERR, 4, "fix mdanim/liquid: density must be > 0, got {}", arg[4]);
  if (strcmp(arg[5], "grid") != 0)
    error->all(FLERR, 5, "fix mdanim/liquid: expected grid NX NY NZ after the density, got {}", arg[5]);
  int n[3];
  for (int d = 0; d < 3; ++d) {
    n[d] = utils::inumeric(FLERR, arg[6 + d], false, lmp);
    if (n[d] < 1) error->all(FLERR, 6 + d, "fix mdanim/liquid: grid must be >= 1 along every axis, got {}", arg[6 + d]);
  }
  // The automaton numbers cells and its rim around them by 32 bits; the state, of a byte a cell and 8 a column, goes into a
  // restart file, whose parts LAMMPS counts by an int.
  const double cells = 1.0 * n[0] * n[1] * n[2], columns_bytes = 8.0 * n[0] * n[1];
  const double with_rim = (n[0] + 3.0) * (n[1] + 2.0) * (n[2] + 2.0), state_bytes = cells + columns_bytes + 1024.0;
  if (std::max(with_rim, state_bytes) > INT_MAX)
    error->all(
        FLERR, 6,
        "fix mdanim/liquid: a grid of {} x {} x {} cells is too large: {:.3g} cells with the rim around them and {:.3g} bytes "
        "of state, {} of each is the limit; use fewer, larger cells",
        n[0], n[1], n[2], with_rim, state_bytes, INT_MAX);

  bool has_volume = false;
  Vertical vertical = Vertical::LOWER;
  for (int iarg = 9; iarg < narg;) {
    if (iarg + 1 >= narg) utils::missing_cmd_args(FLERR, fmt::format("fix mdanim/liquid {}", arg[iarg]), error);
    const char *word = arg[iarg], *value = arg[iarg + 1];
    int used = 2;
    if (strcmp(word, "volume") == 0) {
      volume_asked = utils::numeric(FLERR, value, false, lmp);
      if (!(volume_asked > 0.0)) error->all(FLERR, iarg + 1, "fix mdanim/liquid: volume must be > 0, got {}", value);
      has_volume = true;
    } else if (strcmp(word, "level") == 0) {
      level_asked = utils::numeric(FLERR, value, false, lmp);
      has_level = true;
    } else if (strcmp(word, "fill") == 0) {
      fill_id = value;
      if (!domain->get_region_by_id(fill_id))
        error->all(FLERR, iarg + 1, "fix mdanim/liquid: there is no region {} to fill", value);
    } else if (strcmp(word, "gravity") == 0) {
      g = utils::numeric(FLERR, value, false, lmp);
      if (!(g > 0.0)) error->all(FLERR, iarg + 1, "fix mdanim/liquid: gravity, along -z, must be > 0, got {}", value);
    } else if (strcmp(word, "model") == 0) {
      if (strcmp(value, "surface") == 0)
        model = Model::SURFACE;
      else if (strcmp(value, "paper") == 0)
        model = Model::PAPER;
      else
        error->all(FLERR, iarg + 1, "fix mdanim/liquid: model must be surface or paper, got {}", value);
    } else if (strcmp(word, "vertical") == 0) {
      if (strcmp(value, "lower") == 0)
        vertical = Vertical::LOWER;
      else if (strcmp(value, "any") == 0)
        vertical = Vertical::ANY;
      else
        error->all(FLERR, iarg + 1, "fix mdanim/liquid: vertical must be lower or any, got {}", value);
    } else if (strcmp(word, "seed") == 0) {
      seed = static_cast<std::uint64_t>(utils::bnumeric(FLERR, value, false, lmp));
    } else {
      used = keyword(iarg, narg, arg);
      if (!used)
        error->all(FLERR, iarg,
                   "fix mdanim/liquid: unknown keyword {}; it knows volume, level, fill, gravity, model, vertical, "
                   "seed, buoyancy, drag, lambda, base, cells, faces, still, sweeps, every, stride and period",
                   word);
    }
    iarg += used;
  }
  if (has_volume == has_level)
    error->all(FLERR, "fix mdanim/liquid: write either volume V or level Z, {}", has_level ? "not both" : "one of them");
  if (g < 0.0) error->all(FLERR, "fix mdanim/liquid: gravity G is missing; liquid lies flat only under gravity along -z");

  low = {region->extent_xlo, region->extent_ylo, region->extent_zlo};
  cell = {(region->extent_xhi - low.x) / n[0], (region->extent_yhi - low.y) / n[1], (region->extent_zhi - low.z) / n[2]};
  shortest = std::min({cell.x, cell.y, cell.z});
  if (has_level && !(level_asked > low.z && level_asked <= region->extent_zhi))
    error->all(FLERR, "fix mdanim/liquid: level {} is not within the basin, {} to {}", level_asked, low.z, region->extent_zhi);

  try {
    automaton = std::make_unique<Automaton>(n[0], n[1], n[2], seed, vertical);
    still_count = std::make_unique<Occupancy>(n[0], n[1], n[2]);
    moving_count = std::make_unique<Occupancy>(n[0], n[1], n[2]);
    solid.assign(still_count->count.size(), 0);
  } catch (const std::bad_alloc &) {
    error->one(FLERR, "fix mdanim/liquid: no memory for a grid of {:.3g} cells; use fewer, larger cells", cells);
  }
  height.assign(columns(), 0.0);
  eta.assign(columns(), 0.0);
  blocked.assign(columns(), 0);
  size_array_rows = columns();
}

// Keywords that fix_modify takes as well; returns how many words it used, 0 for a word it does not know.
int FixMdanimLiquid::keyword(int iarg, int narg, char **arg)
{
  const char *word = arg[iarg];
  static const char *const known[] = {"buoyancy", "drag",   "lambda", "base",   "cells", "faces",
                                      "still",    "sweeps", "every",  "stride", "period"};
  if (std::none_of(std::begin(known), std::end(known), [&](const char *k) { return strcmp(k, word) == 0; })) return 0;
  if (iarg + 1 >= narg) utils::missing_cmd_args(FLERR, fmt::format("fix mdanim/liquid {}", word), error);
  const char *value = arg[iarg + 1];
  if (strcmp(word, "buoyancy") == 0) {
    volume = ParticleValue(lmp, "fix mdanim/liquid: buoyancy", iarg + 1, value);
    lifts = true;
  } else if (strcmp(word, "drag") == 0) {
    gamma = ParticleValue(lmp, "fix mdanim/liquid: drag", iarg + 1, value);
    slows = true;
  } else if (strcmp(word, "lambda") == 0 || strcmp(word, "base") == 0) {
    if (!utils::strmatch(value, "^d_"))
      error->all(FLERR, iarg + 1, "fix mdanim/liquid: {} must be a per-particle property d_NAME, got {}", word, value);
    (strcmp(word, "base") == 0 ? base_name : lambda_name) = value + 2;
    writable(value + 2, word);
  } else if (strcmp(word, "cells") == 0 || strcmp(word, "faces") == 0) {
    if (!utils::strmatch(value, "^i2_"))
      error->all(FLERR, iarg + 1, "fix mdanim/liquid: {} must be a per-particle property i2_NAME, got {}", word, value);
    (strcmp(word, "cells") == 0 ? corners_name : faces_name) = value + 3;
  } else if (strcmp(word, "still") == 0) {
    still_bit = group_bit(iarg + 1, value);
  } else if (strcmp(word, "sweeps") == 0) {
    sweeps = strcmp(value, "auto") == 0 ? 0 : utils::inumeric(FLERR, value, false, lmp);
    if (strcmp(value, "auto") != 0 && (sweeps < 1 || sweeps > MOST_SWEEPS))
      error->all(FLERR, iarg + 1, "fix mdanim/liquid: sweeps must be auto or 1 to {}, got {}", MOST_SWEEPS, value);
  } else if (strcmp(word, "stride") == 0 || strcmp(word, "period") == 0) {
    double &number = strcmp(word, "stride") == 0 ? stride : period;
    number = utils::numeric(FLERR, value, false, lmp);
    if (!(number > 0.0)) error->all(FLERR, iarg + 1, "fix mdanim/liquid: {} must be > 0, got {}", word, value);
  } else {
    every = utils::inumeric(FLERR, value, false, lmp);
    if (every < 1) error->all(FLERR, iarg + 1, "fix mdanim/liquid: every must be >= 1, got {}", value);
  }
  return 2;
}

int FixMdanimLiquid::modify_param(int narg, char **arg) { return keyword(0, narg, arg); }

int FixMdanimLiquid::group_bit(int iarg, const char *word)
{
  const int index = group->find(word);
  if (index < 0) error->all(FLERR, iarg, "fix mdanim/liquid: there is no group {}; make it before this fix", word);
  return group->bitmask[index];
}

// A per-particle property that this fix reads and writes itself.
double *FixMdanimLiquid::writable(const std::string &name, const char *keyword)
{
  int is_double = 0, width = 0;
  const int index = atom->find_custom(name.c_str(), is_double, width);
  if (index < 0 || !is_double || width)
    error->all(FLERR,
               "fix mdanim/liquid: {} names d_{}, which is no per-particle property; make it with 'fix ID all "
               "property/atom d_{}'",
               keyword, name, name);
  return atom->dvector[index];
}

// Columns of a per-particle table of tags; 0 when there is no such table.
int FixMdanimLiquid::width_of(const std::string &name) const
{
  int is_double = 0, width = 0;
  const int index = atom->find_custom(name.c_str(), is_double, width);
  return index < 0 || is_double ? 0 : width;
}

int *const *FixMdanimLiquid::table_of(const std::string &name) const
{
  int is_double = 0, width = 0;
  return atom->iarray[atom->find_custom(name.c_str(), is_double, width)];
}

int FixMdanimLiquid::setmask() { return POST_NEIGHBOR | POST_FORCE | END_OF_STEP; }

void FixMdanimLiquid::init()
{
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR, "fix {} mdanim/liquid: run_style respa is not supported; use run_style verlet", id);
  if (domain->dimension != 3) error->all(FLERR, "fix {} mdanim/liquid: dimension must be 3, got {}", id, domain->dimension);
  if (domain->triclinic) error->all(FLERR, "fix {} mdanim/liquid: a triclinic box is not supported", id);
  if (domain->xperiodic || domain->yperiodic || domain->zperiodic)
    error->all(FLERR, "fix {} mdanim/liquid: periodic boundaries are not supported; use boundary s, f or m", id);
  if (slows && lambda_name.empty())
    error->all(FLERR, "fix {} mdanim/liquid: drag needs lambda d_NAME, the property that fix mdanim/leapfrog reads", id);
  if (!slows && !(lambda_name.empty() && base_name.empty()))
    error->all(FLERR, "fix {} mdanim/liquid: lambda and base say where drag goes, but there is no drag; add one", id);
  if (slows && !lifts)
    error->all(FLERR, "fix {} mdanim/liquid: drag acts on the volume of particles, which buoyancy gives; add buoyancy", id);
  if (lifts) volume.init(lmp);
  if (slows) gamma.init(lmp);
  if (!corners_name.empty() && width_of(corners_name) != 7)
    error->all(FLERR,
               "fix {} mdanim/liquid: cells names i2_{}, which is no property of 7 integers; make it with 'fix ID all "
               "property/atom i2_{} 7 ghost yes'",
               id, corners_name, corners_name);
  if (!faces_name.empty()) {
    faces_width = width_of(faces_name);
    if (faces_width == 0 || faces_width % 3)
      error->all(FLERR,
                 "fix {} mdanim/liquid: faces names i2_{}, which is no property of 3 integers a face; make it with 'fix ID all "
                 "property/atom i2_{} 36'",
                 id, faces_name, faces_name);
    if (model == Model::PAPER)
      error->all(FLERR, "fix {} mdanim/liquid: model paper knows no pressure on faces; leave faces out", id);
  }
  if (!(corners_name.empty() && faces_name.empty()) && atom->map_style == Atom::MAP_NONE)
    error->all(FLERR, "fix {} mdanim/liquid: cells and faces need an atom map; use 'atom_modify map array'", id);
  // Lists are then rebuilt as soon as a particle has moved by half the skin.
  watching = neighbor->every == 1 && neighbor->delay == 0 && !neighbor->build_once;
}

// --- solids on the grid ---

Vec3 FixMdanimLiquid::in_cells(const double *x) const
{ return {(x[0] - low.x) / cell.x, (x[1] - low.y) / cell.y, (x[2] - low.z) / cell.z}; }

// Bodies that never move (or all others), as far as they reach below a height in cells.
void FixMdanimLiquid::add_bodies(Occupancy &into, bool still, double below)
{
  double *const *x = atom->x;
  const int *mask = atom->mask, nlocal = atom->nlocal;
  if (corners_name.empty() || model == Model::PAPER) {
    for (int i = 0; i < nlocal; ++i) {
      if (!(mask[i] & groupbit) || static_cast<bool>(mask[i] & still_bit) != still) continue;
      const Vec3 place = in_cells(x[i]);
      if (place.z <= below) into.add_particle(place);
    }
    return;
  }
  int *const *corners = table_of(corners_name);
  for (int i = 0; i < nlocal; ++i) {
    if (!(mask[i] & groupbit) || corners[i][0] == 0) continue;
    int at[8] = {i};
    int all = mask[i];
    for (int k = 0; k < 7; ++k) {
      at[k + 1] = atom->map(corners[i][k]);
      if (at[k + 1] < 0)
        error->one(FLERR,
                   "fix {} mdanim/liquid: particle {}, a corner of the lattice cell of particle {}, is out of reach; raise "
                   "comm_modify cutoff",
                   id, corners[i][k], atom->tag[i]);
      all &= mask[at[k + 1]];
    }
    if (static_cast<bool>(all & still_bit) != still) continue;
    Vec3 corner[8];
    double lowest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 8; ++k) {
      corner[k] = in_cells(x[at[k]]);
      lowest = std::min(lowest, corner[k].z);
    }
    if (lowest <= below) into.add_cell(corner);
  }
}

// Whole numbers: the sum does not depend on which rank holds what.
void FixMdanimLiquid::sum_over_ranks(Occupancy &counted)
{
  if (comm->nprocs == 1) return;
  CellBox &box = counted.touched;
  int here[6], all[6];
  for (int d = 0; d < 3; ++d) {
    here[d] = box.low[d];
    here[3 + d] = -box.high[d];
  }
  MPI_Allreduce(here, all, 6, MPI_INT, MPI_MIN, world);
  for (int d = 0; d < 3; ++d) {
    box.low[d] = all[d];
    box.high[d] = -all[3 + d];
  }
  if (box.empty()) return;
  std::vector<int> part(box.size());
  const int width = box.high[0] - box.low[0];
  const auto rows = [&](auto &&copy) {
    int *packed = part.data();
    for (int z = box.low[2]; z < box.high[2]; ++z)
      for (int y = box.low[1]; y < box.high[1]; ++y, packed += width)
        copy(&counted.count[(static_cast<std::size_t>(z) * counted.ny + y) * counted.nx + box.low[0]], packed);
  };
  rows([&](const int *grid, int *packed) { std::copy_n(grid, width, packed); });
  MPI_Allreduce(MPI_IN_PLACE, part.data(), static_cast<int>(part.size()), MPI_INT, MPI_SUM, world);
  rows([&](int *grid, const int *packed) { std::copy_n(packed, width, grid); });
}

// Marks what never moves, as it stands now; returns how many cells that changes.
long FixMdanimLiquid::count_still()
{
  const Lap lap(occupancy_seconds);
  CellBox box = still_count->touched;
  still_count->clear();
  add_bodies(*still_count, true, std::numeric_limits<double>::infinity());
  sum_over_ranks(*still_count);
  box.take_in(still_count->touched);
  long changed = 0;
  box.each([&](int x, int y, int z) {
    const std::uint64_t c = automaton->cells.number(x, y, z);
    const bool still = 2 * still_count->count[c] >= Occupancy::FULL;
    if (still == (solid[c] == 2)) return;
    solid[c] = still ? 2 : 0;
    ++changed;
  });
  return changed;
}

void FixMdanimLiquid::count_moving()
{
  const Lap lap(occupancy_seconds);
  CellBox before = moving_count->touched;
  moving_count->clear();
  add_bodies(*moving_count, false, poured ? top + SAMPLED : std::numeric_limits<double>::infinity());
  sum_over_ranks(*moving_count);
  before.take_in(moving_count->touched);
  moving_solid = 0;
  before.each([&](int x, int y, int z) {
    const std::uint64_t c = automaton->cells.number(x, y, z);
    if (solid[c] == 2) return;
    solid[c] = 2 * (still_count->count[c] + moving_count->count[c]) >= Occupancy::FULL;
    moving_solid += solid[c];
  });
}

// --- the liquid ---

// The start: solids first, then liquid into what they leave.
void FixMdanimLiquid::pour()
{
  const Cells &cells = automaton->cells;
  count_moving();
  const auto now = static_cast<std::uint64_t>(update->ntimestep);
  automaton->displace(solid.data(), now);

  std::vector<std::uint8_t> within(solid.size(), 1);
  if (!fill_id.empty()) {
    Region *fill = domain->get_region_by_id(fill_id);
    if (!fill) error->all(FLERR, "fix {} mdanim/liquid: region {} has been deleted", id, fill_id);
    fill->prematch();
    cells.each([&](int x, int y, int z) {
      within[cells.number(x, y, z)] =
          fill->match(low.x + (x + 0.5) * cell.x, low.y + (y + 0.5) * cell.y, low.z + (z + 0.5) * cell.z);
    });
  }
  if (has_level) {
    // Whole layers below the level, and of the layer that it cuts the same part of the open cells.
    const double depth = (level_asked - low.z) / cell.z;
    units = 0;
    for (int z = 0; z < cells.nz && z < depth; ++z) {
      std::int64_t open = 0;
      for (int y = 0; y < cells.ny; ++y)
        for (int x = 0; x < cells.nx; ++x) {
          const std::uint64_t c = cells.number(x, y, z);
          open += within[c] && !solid[c];
        }
      units += static_cast<std::int64_t>(std::min(1.0, depth - z) * static_cast<double>(open) + 0.5);
    }
  } else {
    units = static_cast<std::int64_t>(volume_asked / (cell.x * cell.y * cell.z) + 0.5);
  }
  if (units < 1)
    error->all(FLERR, "fix {} mdanim/liquid: {} is less than half a cell of liquid; use more liquid or smaller cells", id,
               has_level ? fmt::format("level {}", level_asked) : fmt::format("volume {}", volume_asked));
  const long left = automaton->fill(units, within.data(), now);
  if (left)
    error->all(FLERR,
               "fix {} mdanim/liquid: {} of {} cells of liquid find no room beside the solids in {}; use less liquid or a larger "
               "basin",
               id, left, units, fill_id.empty() ? "the basin" : "the region to fill");
  poured = true;
  raise_surface(false);
}

// Heights, and the surface that solids feel, from the cells as they are now.
void FixMdanimLiquid::raise_surface(bool just_levelled)
{
  const Lap lap(automaton_seconds);
  calm = leveller.heights(automaton->cells, height.data(), just_levelled);
  smooth();
}

void FixMdanimLiquid::smooth()
{
  const Cells &cells = automaton->cells;
  top = cells.nz;
  while (top > 0 && std::all_of(&cells.content[cells.at(-1, -1, top - 1)],
                                &cells.content[cells.at(-1, -1, top - 1)] + cells.layer, [](std::uint8_t q) { return q == 0; }))
    --top;
  // A column is parted where what ends its liquid never moves: each side of a wall has a level of its own.
  for (int y = 0; y < cells.ny; ++y)
    for (int x = 0; x < cells.nx; ++x) {
      const std::size_t column = static_cast<std::size_t>(y) * cells.nx + x;
      blocked[column] = 0;
      if (!std::isnan(height[column])) continue;
      int z = top - 1;
      while (z >= 0 && !cells.content[cells.at(x, y, z)]) --z;
      if (z < 0)    // dry: what stands on the floor or hangs above it
        while (++z < cells.nz && cells.open[cells.at(x, y, z)]) {}
      else if (z + 1 < cells.nz && !cells.open[cells.at(x, y, z + 1)])
        ++z;    // what shuts the liquid in
      else
        while (z >= 0 && cells.open[cells.at(x, y, z)]) --z;    // what a film lies on
      blocked[column] = z >= 0 && z < cells.nz && cells.still[cells.at(x, y, z)];
    }
  smooth_surface(cells.nx, cells.ny, height.data(), blocked.data(), eta.data());
  // Under a lid from wall to wall no column tells a height: then it is that up to which the open cells would
  // hold the liquid.
  if (std::all_of(height.begin(), height.end(), [](double h) { return std::isnan(h); }))
    std::fill(eta.begin(), eta.end(), shut_in_height());
  lowest_eta = *std::min_element(eta.begin(), eta.end());
}

// Height up to which open cells, from the lowest layer up, hold all the liquid [cells].
double FixMdanimLiquid::shut_in_height() const
{
  const Cells &cells = automaton->cells;
  std::int64_t left = automaton->total();
  for (int z = 0; z < cells.nz; ++z) {
    std::int64_t open = 0;
    for (int y = 0; y < cells.ny; ++y)
      for (int x = 0; x < cells.nx; ++x) open += cells.open[cells.at(x, y, z)] != Cells::SOLID;
    if (open && left <= open) return z + static_cast<double>(left) / static_cast<double>(open);
    left -= open;
  }
  return cells.nz;
}

// Whether it is time for an update. Depends on the state alone, so that neither ranks nor pieces of a run
// change it. Counts a step only once.
bool FixMdanimLiquid::due()
{
  if (update->ntimestep % every != 0) return false;
  if (asked != update->ntimestep) is_due = find_out_whether_due();
  asked = update->ntimestep;
  return is_due;
}

bool FixMdanimLiquid::find_out_whether_due()
{
  double fastest = -1.0;    // squared; -1 when no solid is near the liquid
  if (!nobody) {
    const Lap lap(coupling_seconds);
    const double *const *x = atom->x, *const *v = atom->v;
    const double below = low.z + (top + NEAR) * cell.z;
    for (const int i : watched)
      if (x[i][2] < below) fastest = std::max(fastest, dot(vec3(v[i]), vec3(v[i])));
    if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, &fastest, 1, MPI_DOUBLE, MPI_MAX, world);
  }
  if (!calm) waited += every;
  if (fastest >= 0.0)
    travel += std::sqrt(fastest) * every * update->dt / shortest;
  else if (moving_solid)
    return true;    // the last one has just left
  if (travel >= stride) return true;
  return !calm && waited * update->dt >= period * std::sqrt(shortest / g);
}

// Liquid leaves the cells that have become solid; returns how many have changed.
long FixMdanimLiquid::make_room()
{
  const Lap lap(automaton_seconds);
  try {
    return automaton->displace(solid.data(), static_cast<std::uint64_t>(update->ntimestep));
  } catch (const std::runtime_error &problem) {
    error->all(FLERR, "fix {} mdanim/liquid: {}", id, problem.what());
  }
  return 0;
}

void FixMdanimLiquid::update_liquid()
{
  count_moving();
  const long changed = make_room();
  if (changed || !calm) flow(changed);
  travel = 0.0;
  waited = 0;
  if (low.z + top * cell.z <= watched_top) return;
  watch(neighbor->skin);                                // who went one way since lists were made may go as far the other way
  lowest = -std::numeric_limits<double>::infinity();    // then, that is not known
}

// Lets the liquid move: sweeps, and the level rule as often as a wave has gone half a cell or solids have
// changed cells.
void FixMdanimLiquid::flow(long changed)
{
  bool levelled = false;
  int most = 0;
  {
    const Lap lap(automaton_seconds);
    const auto now = static_cast<std::uint64_t>(update->ntimestep);
    // A front goes on by one cell in a move: half a cell of wave between moves makes its speed 2 sqrt(g
    // depth), that of the front of a broken dam.
    crossed += std::sqrt(g * top * cell.z) * waited * update->dt / shortest;
    const bool wave = crossed >= 0.5;
    const int wanted = std::max(static_cast<int>(SWEEPS_PER_CELL * travel + 0.5), wave || changed ? 1 : 0);
    most = sweeps ? sweeps : std::min(wanted, MOST_SWEEPS);
    for (int k = 0; k < most; ++k) automaton->sweep(now * MOST_SWEEPS + k);
    swept += most;
    levelled = model == Model::SURFACE && (wave || changed);
    if (levelled && leveller.move(automaton->cells, seed, now, wave ? LEVEL_RATE * crossed : 0.0, changed)) automaton->poured();
    if (wave) crossed = 0.0;
  }
  if (changed || most || levelled) raise_surface(levelled);
}

// --- solids in the liquid ---

void FixMdanimLiquid::setup_post_neighbor()
{
  const long changed = count_still();
  if (!poured)
    pour();
  else if (changed) {    // somebody has moved what never moves, between two runs
    make_room();
    raise_surface(false);
  }
  nobody = false;    // between two runs anything may have been set
  asked = -1;
  post_neighbor();
}

void FixMdanimLiquid::post_neighbor()
{
  const Lap lap(coupling_seconds);
  watch(0.5 * neighbor->skin);
}

// Particles that can come near the liquid before they have moved by `margin`. All others have no friction from it.
void FixMdanimLiquid::watch(double margin)
{
  watched.clear();
  watched_top = low.z + top * cell.z;
  const double below = watching ? watched_top + NEAR * cell.z + margin : std::numeric_limits<double>::infinity();
  // The box holds all particles as they stood at the last rebuild: where nobody was near, and all of it is above, nobody has
  // come.
  lowest = domain->boxlo[2];
  if (nobody && watching && lowest > below + 0.5 * neighbor->skin) return;
  lowest = std::numeric_limits<double>::infinity();
  double *lambda = slows ? writable(lambda_name, "lambda") : nullptr;
  const double *base = base_name.empty() ? nullptr : writable(base_name, "base");
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    if (lambda) lambda[i] = base ? base[i] : 0.0;
    if (atom->mask[i] & still_bit) continue;
    lowest = std::min(lowest, atom->x[i][2]);
    if (atom->x[i][2] < below) watched.push_back(i);
  }
  if (!faces_name.empty()) find_faces();
  int here = !watched.empty(), any = here;
  if (comm->nprocs > 1) MPI_Allreduce(&here, &any, 1, MPI_INT, MPI_MAX, world);
  nobody = !any;
}

void FixMdanimLiquid::setup(int)
{
  couple();
  last_power = power(last_loss);
}

void FixMdanimLiquid::post_force(int)
{
  if (due()) update_liquid();
  couple();
}

bool FixMdanimLiquid::over_basin(const double *x) const
{
  return x[0] >= low.x && x[0] <= low.x + automaton->cells.nx * cell.x && x[1] >= low.y &&
         x[1] <= low.y + automaton->cells.ny * cell.y;
}

// Part of the volume around a particle that counts as immersed.
double FixMdanimLiquid::immersed(const Vec3 &place) const
{
  const Cells &cells = automaton->cells;
  if (!(place.x >= 0.0 && place.x <= cells.nx && place.y >= 0.0 && place.y <= cells.ny)) return 0.0;
  if (model == Model::SURFACE)
    return immersed_part(at_point(eta.data(), blocked.data(), cells.nx, cells.ny, place.x, place.y), place.z);
  // The paper's own words: liquid in any of the cells around.
  if (!(place.z >= 0.0 && place.z < cells.nz)) return 0.0;
  const int x = std::min(static_cast<int>(place.x), cells.nx - 1), y = std::min(static_cast<int>(place.y), cells.ny - 1),
            z = static_cast<int>(place.z);
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (cells.content[cells.at(x + dx, y + dy, z + dz)]) return 1.0;
  return 0.0;
}

void FixMdanimLiquid::couple()
{
  wet.clear();
  if (!lifts || watched.empty()) return;
  const Lap lap(coupling_seconds);
  double *const *x = atom->x, *const *f = atom->f;
  const double *volumes = volume.values(lmp), *gammas = slows ? gamma.values(lmp) : nullptr;
  double *lambda = slows ? writable(lambda_name, "lambda") : nullptr;
  const double *base = base_name.empty() ? nullptr : writable(base_name, "base");
  for (Face &face : faces) face.push = pressure_on(face);
  const double above = low.z + (top + 1.0) * cell.z;    // nothing is immersed from here up
  // All is from here down, as far as the basin reaches; most particles of a large body need not look up the
  // surface.
  const bool deep = model == Model::SURFACE && lowest_eta >= 1.0;
  const double below = deep ? low.z + (lowest_eta - 0.5) * cell.z : -std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < watched.size(); ++n) {
    const int i = watched[n];
    const double z = x[i][2];
    const double s = z >= above ? 0.0 : z <= below && over_basin(x[i]) ? 1.0 : immersed(in_cells(x[i]));
    const double own = volumes ? volumes[i] : volume.number;
    const double own_lambda = slows ? liquid_lambda(gammas ? gammas[i] : gamma.number, rho, own, s) / force->ftm2v : 0.0;
    if (lambda) lambda[i] = (base ? base[i] : 0.0) + own_lambda;
    Vec3 push;
    if (faces_name.empty())
      push.z = lift(rho, own, s, g);
    else
      for (int k = face_of_first[n]; k < face_of_first[n + 1]; ++k) push += faces[face_of[k]].push;
    if (s == 0.0 && dot(push, push) == 0.0) continue;
    add_to(f[i], push);
    wet.push_back({i, push, own_lambda});
  }
}

// The faces of the watched particles, each once, with its corners in an order that does not depend on who
// asks.
void FixMdanimLiquid::find_faces()
{
  faces.clear();
  face_of.clear();
  face_of_first.assign(1, 0);
  int *const *table = table_of(faces_name);
  std::unordered_map<std::uint64_t, int> known;    // by the tags across: no other face has both
  for (const int i : watched) {
    for (int k = 0; k < faces_width && table[i][k]; k += 3) {
      tagint tag[4] = {atom->tag[i], table[i][k], table[i][k + 1], table[i][k + 2]};
      std::rotate(tag, std::min_element(tag, tag + 4), tag + 4);
      const auto [place, is_new] = known.try_emplace(
          static_cast<std::uint64_t>(tag[0]) << 32 | static_cast<std::uint32_t>(tag[2]), static_cast<int>(faces.size()));
      face_of.push_back(place->second);
      if (!is_new) continue;
      Face face;
      for (int n = 0; n < 4; ++n) {
        face.corner[n] = atom->map(tag[n]);
        if (face.corner[n] < 0)
          error->one(FLERR,
                     "fix {} mdanim/liquid: particle {}, a corner of a face of particle {}, is out of reach; raise comm_modify "
                     "cutoff",
                     id, tag[n], atom->tag[i]);
      }
      faces.push_back(face);
    }
    face_of_first.push_back(static_cast<int>(face_of.size()));
  }
}

// What hydrostatic pressure does to each corner of a face.
Vec3 FixMdanimLiquid::pressure_on(const Face &face) const
{
  const double *const *x = atom->x;
  const Vec3 a = vec3(x[face.corner[0]]), b = vec3(x[face.corner[1]]), c = vec3(x[face.corner[2]]), d = vec3(x[face.corner[3]]);
  const Vec3 middle = 0.25 * ((a + c) + (b + d));
  if (!over_basin(&middle.x)) return {};
  const Vec3 place = in_cells(&middle.x);
  const double depth = at_point(eta.data(), blocked.data(), automaton->cells.nx, automaton->cells.ny, place.x, place.y) - place.z;
  if (depth <= 0.0) return {};
  if (depth > SPLASH) {
    const Vec3 area = cross(c - a, d - b);
    const double size = std::sqrt(dot(area, area));
    if (size == 0.0 || looks_into_air(middle, (1.0 / size) * area)) return {};
  }
  return corner_push(rho * g * depth * cell.z, a, b, c, d);
}

// Whether a face below the surface has air before it all the same, as the inside of a hull does: no liquid in
// the first open cell along its normal, and none above that. The nearest cells may be solid, for they are
// only roughly where the face is.
bool FixMdanimLiquid::looks_into_air(const Vec3 &middle, const Vec3 &normal) const
{
  const Cells &cells = automaton->cells;
  for (const double far : {0.75, 1.25, 1.75, 2.25}) {
    const Vec3 there = middle + (far * shortest) * normal, place = in_cells(&there.x);
    if (!(place.x >= 0.0 && place.x < cells.nx && place.y >= 0.0 && place.y < cells.ny && place.z >= 0.0 && place.z < cells.nz))
      return false;
    const int x = static_cast<int>(place.x), y = static_cast<int>(place.y);
    int z = static_cast<int>(place.z);
    if (!cells.open[cells.at(x, y, z)]) continue;
    while (z < top && !cells.content[cells.at(x, y, z)]) ++z;
    return z >= top;
  }
  return false;
}

// Power of buoyancy, and what drag takes, at the velocities of now; on this rank.
double FixMdanimLiquid::power(double &loss) const
{
  double gain = 0.0;
  loss = 0.0;
  for (const Wet &w : wet) {
    const Vec3 v = vec3(atom->v[w.i]);
    gain += dot(w.push, v);
    loss += w.lambda * dot(v, v);
  }
  return gain;
}

// Velocities are those of whole steps here, eq. (3.10), which are the means of the half steps before and
// after: the trapezoidal rule gives the work exactly.
void FixMdanimLiquid::end_of_step()
{
  if (wet.empty() && last_power == 0.0 && last_loss == 0.0) return;
  const Lap lap(coupling_seconds);
  double loss = 0.0;
  const double gain = power(loss);
  work += 0.5 * update->dt * (last_power + gain);
  lost += 0.5 * update->dt * (last_loss + loss);
  last_power = gain;
  last_loss = loss;
}

// --- together with run_style verlet/mdanim ---

// Faces push at the corners that ask for them and are read at all four, which are of one object and mostly all watched.
void FixMdanimLiquid::append_required_atoms(std::vector<int> &particles) const
{
  particles.insert(particles.end(), watched.begin(), watched.end());
  for (const Face &face : faces) particles.insert(particles.end(), face.corner, face.corner + 4);
}

// An update of the liquid looks for all bodies.
bool FixMdanimLiquid::needs_all_atoms() { return due(); }

// While the liquid is level and nobody is near it, until somebody comes.
double FixMdanimLiquid::safe_displacement() const { return watching && asleep() ? lowest - (watched_top + NEAR * cell.z) : 0.0; }

// --- what it tells ---

double FixMdanimLiquid::compute_scalar()
{
  double all = 0.0;
  MPI_Allreduce(&work, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return -all;
}

// 1 units of liquid; 2 at the start; 3 mean level; 4 solid cells; 5 sweeps; 6 awake; 7 energy lost to drag;
// wall seconds of the slowest rank for 8 automaton, 9 occupancy, 10 coupling, 11 all
double FixMdanimLiquid::compute_vector(int n)
{
  double all = 0.0;
  switch (n) {
    case 0:
      return static_cast<double>(automaton->total());
    case 1:
      return static_cast<double>(units);
    case 2:
      for (const double h : eta) all += h;
      return low.z + cell.z * all / columns();
    case 3:
      return static_cast<double>(automaton->count_solid());
    case 4:
      return static_cast<double>(swept);
    case 5:
      return !(calm && nobody);
    case 6:
      MPI_Allreduce(&lost, &all, 1, MPI_DOUBLE, MPI_SUM, world);
      return all;
    default:
      break;
  }
  double here[] = {automaton_seconds, occupancy_seconds, coupling_seconds,
                   automaton_seconds + occupancy_seconds + coupling_seconds};
  MPI_Allreduce(&here[n - 7], &all, 1, MPI_DOUBLE, MPI_MAX, world);
  return all;
}

// A row per column of cells: x, y of its centre, z of the smooth surface, z of the topmost liquid (NaN where
// a body hides it).
double FixMdanimLiquid::compute_array(int row, int column)
{
  const int nx = automaton->cells.nx;
  switch (column) {
    case 0:
      return low.x + (row % nx + 0.5) * cell.x;
    case 1:
      return low.y + (row / nx + 0.5) * cell.y;
    case 2:
      return low.z + eta[row] * cell.z;
    default:
      return low.z + height[row] * cell.z;
  }
}

// Open cells without liquid right below a height in cells; none where there is liquid above.
static int air_below(const Cells &cells, int x, int y, double height)
{
  const int first = std::min(static_cast<int>(height), cells.nz) - 1;
  for (int z = first + 1; z < cells.nz; ++z)
    if (cells.content[cells.at(x, y, z)]) return 0;
  int z = first;
  while (z >= 0 && cells.open[cells.at(x, y, z)] && !cells.content[cells.at(x, y, z)]) --z;
  return first - z;
}

// Of the columns that tell no height those with air below the surface count as kept dry, as a hull keeps its
// inside, where the air is two cells deep, and all around as far as it goes on: over what has just gone under
// the liquid closes a little late.
void FixMdanimLiquid::surface(double *smooth, double *raw) const
{
  const Cells &cells = automaton->cells;
  std::vector<int> air(columns(), 0), dry;
  for (int c = 0; c < columns(); ++c) {
    smooth[c] = low.z + eta[c] * cell.z;
    raw[c] = low.z + height[c] * cell.z;
    if (std::isnan(height[c])) air[c] = air_below(cells, c % cells.nx, c / cells.nx, eta[c]);
    if (air[c] >= 2) dry.push_back(c);
  }
  while (!dry.empty()) {
    const int c = dry.back(), x = c % cells.nx, y = c / cells.nx;
    dry.pop_back();
    if (!air[c]) continue;
    air[c] = 0;
    raw[c] = -std::numeric_limits<double>::infinity();
    if (x > 0) dry.push_back(c - 1);
    if (x + 1 < cells.nx) dry.push_back(c + 1);
    if (y > 0) dry.push_back(c - cells.nx);
    if (y + 1 < cells.ny) dry.push_back(c + cells.nx);
  }
}

void FixMdanimLiquid::contents(std::uint8_t *out) const
{
  const Cells &cells = automaton->cells;
  cells.each([&](int x, int y, int z) {
    const std::size_t c = cells.at(x, y, z);
    *out++ = cells.open[c] ? cells.content[c] : SOLID_CODE;
  });
}

double FixMdanimLiquid::memory_usage()
{
  return 3.0 * automaton->cells.content.size() + solid.size() * (1.0 + 2.0 * sizeof(int)) +
         columns() * (2.0 * sizeof(double) + 1.0) + watched.capacity() * sizeof(int) + wet.capacity() * sizeof(Wet);
}

// --- state ---

namespace {
struct StateHead {
  double version;
  std::int64_t nx, ny, nz;
  std::int64_t units, swept, waited, calm;
  double travel, crossed, work, lost;
};
}    // namespace

std::vector<std::uint8_t> FixMdanimLiquid::state() const
{
  const Cells &cells = automaton->cells;
  StateHead head{STATE_VERSION, cells.nx, cells.ny, cells.nz, units, swept, waited, calm, travel, crossed, 0.0, 0.0};
  MPI_Allreduce(&work, &head.work, 1, MPI_DOUBLE, MPI_SUM, world);
  MPI_Allreduce(&lost, &head.lost, 1, MPI_DOUBLE, MPI_SUM, world);
  const std::size_t heights = height.size() * sizeof(double);
  std::vector<std::uint8_t> bytes(sizeof head + heights + solid.size());
  memcpy(bytes.data(), &head, sizeof head);
  memcpy(bytes.data() + sizeof head, height.data(), heights);
  std::uint8_t *content = bytes.data() + sizeof head + heights;
  contents(content);
  for (std::size_t c = 0; c < solid.size(); ++c)
    if (content[c] == SOLID_CODE && solid[c] == 2) content[c] = STILL_CODE;
  return bytes;
}

std::string FixMdanimLiquid::set_state(const std::uint8_t *bytes, std::size_t size)
{
  Cells &cells = automaton->cells;
  StateHead head;
  const std::size_t heights = height.size() * sizeof(double);
  if (size < sizeof head) return fmt::format("the liquid's state has {} bytes, that is too few", size);
  memcpy(&head, bytes, sizeof head);
  if (head.version != STATE_VERSION)
    return fmt::format("the liquid's state has version {}, {} is needed", head.version, STATE_VERSION);
  if (head.nx != cells.nx || head.ny != cells.ny || head.nz != cells.nz || size != sizeof head + heights + solid.size())
    return fmt::format("the liquid's state is of a grid of {} x {} x {} cells, this one has {} x {} x {}", head.nx, head.ny,
                       head.nz, cells.nx, cells.ny, cells.nz);
  // A byte of the grid is what a cell holds, or a code.
  const std::uint8_t *content = bytes + sizeof head + heights;
  std::int64_t held = 0;
  for (std::size_t c = 0; c < solid.size(); ++c) {
    if (content[c] >= STILL_CODE) continue;
    if (content[c] > Cells::FULLEST) return fmt::format("the liquid's state is damaged: a cell holds {}", content[c]);
    held += content[c];
  }
  if (held != head.units)
    return fmt::format("the liquid's state is damaged: it holds {} units of liquid, not {}", held, head.units);
  units = head.units;
  swept = head.swept;
  waited = head.waited;
  calm = head.calm != 0;
  asked = -1;
  travel = head.travel;
  crossed = head.crossed;
  work = comm->me == 0 ? head.work : 0.0;
  lost = comm->me == 0 ? head.lost : 0.0;
  memcpy(height.data(), bytes + sizeof head, heights);

  // Solids first: an empty grid loses nothing to them.
  std::fill(cells.content.begin(), cells.content.end(), 0);
  moving_count->clear();
  moving_solid = 0;
  cells.each([&](int x, int y, int z) {
    const std::uint64_t c = cells.number(x, y, z);
    solid[c] = content[c] == STILL_CODE ? 2 : content[c] == SOLID_CODE ? 1 : 0;
    if (solid[c] != 1) return;
    moving_count->touched.take_in(x, y, z);
    ++moving_solid;
  });
  automaton->displace(solid.data(), 0);
  cells.each([&](int x, int y, int z) {
    const std::uint64_t c = cells.number(x, y, z);
    if (!solid[c]) cells.content[cells.at(x, y, z)] = content[c];
  });
  automaton->touched();
  poured = true;
  smooth();
  return "";
}

StateRecords FixMdanimLiquid::pack() const { return {{StateKey{}, state()}}; }

void FixMdanimLiquid::unpack(const StateRecords &records)
{
  if (records.size() != 1 || records.begin()->first.a != 0)
    throw std::runtime_error(fmt::format("the liquid's state is one record (0, 0), there are {} records", records.size()));
  const Bytes &record = records.begin()->second;
  const std::string why = set_state(record.data(), record.size());
  if (!why.empty()) throw std::runtime_error(why);
}

void FixMdanimLiquid::write_restart(FILE *file)
{ mdanim::write_restart(*this, lmp, fmt::format("fix {} mdanim/liquid", id), file); }

void FixMdanimLiquid::restart(char *buffer) { mdanim::read_restart(*this, lmp, fmt::format("fix {} mdanim/liquid", id), buffer); }
