// SPDX-License-Identifier: GPL-2.0-only
// The command, the particles near the liquid, and output.

#include "lammps/fix_mdanim_liquid.h"
#include "lammps/keywords.h"
#include "lammps/object_table.h"

#include "liquid/automaton/automaton_basin.h"
#include "liquid/waves/wave_basin.h"
#include "numbers/stopwatch.h"
#include "numbers/vec3.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "lammps.h"
#include "neighbor.h"
#include "region.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <limits>
#include <new>
#include <stdexcept>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static const char *const STYLE = "fix mdanim/liquid";
static const char *const LEFT_OUT = ", or leave it out of the group of this fix";

// Keywords of the command only, and those that fix_modify takes as well.
static const std::vector<Keyword> FIXED = {{"volume", "V"},
                                           {"level", "Z"},
                                           {"fill", "REGION2"},
                                           {"gravity", "G"},
                                           {"model", "surface|paper|waves"},
                                           {"calm", "T"},
                                           {"drops", "share"},
                                           {"wave", "SIDE a T"},
                                           {"current", "SIDE u"},
                                           {"inflow", "REGION2 q ux uy"},
                                           {"drain", "REGION2 q"},
                                           {"vertical", "lower|any"},
                                           {"seed", "N"}};
static const std::vector<Keyword> FREE = {{"buoyancy", "V|d_NAME"},
                                          {"drag", "gamma|d_NAME"},
                                          {"quadratic", "k|d_NAME"},
                                          {"lambda", "d_NAME"},
                                          {"base", "d_NAME"},
                                          {"cells", "i2_NAME"},
                                          {"softness", "d_NAME"},
                                          {"still", "GROUP"},
                                          {"sweeps", "auto|N"},
                                          {"every", "N"},
                                          {"stride", "s"},
                                          {"period", "p"},
                                          {"faces", "", "write model waves, in which open hulls float by the air in them"}};
static constexpr double ANYWHERE = std::numeric_limits<double>::infinity();

bool FixMdanimLiquid::WorldSums::alone() const { return lmp->comm->nprocs == 1; }

void FixMdanimLiquid::WorldSums::add(int *values, int count) const
{ MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_INT, MPI_SUM, lmp->world); }

bool FixMdanimLiquid::WorldSums::first() const { return lmp->comm->me == 0; }

void FixMdanimLiquid::WorldSums::add_wide(std::int64_t *values, int count) const
{
  if (!alone()) MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_INT64_T, MPI_SUM, lmp->world);
}

void FixMdanimLiquid::WorldSums::lowest(int *values, int count) const
{ MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_INT, MPI_MIN, lmp->world); }

// --- the command ---

// fix ID group mdanim/liquid REGION rho grid NX NY NZ volume V | level Z gravity G keyword values ...
FixMdanimLiquid::FixMdanimLiquid(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg), sums(lmp)
{
  array_flag = 1;
  size_array_cols = 4;
  extarray = 0;
  nevery = 1;
  restart_global = 1;
  need(THREE_DIMENSIONS | ORTHOGONAL_BOX | OPEN_BOX);
  look_up({&still_group}, {});
  tell_numbers();

  need_words(lmp, STYLE, "fix ID group mdanim/liquid", "REGION rho grid NX NY NZ", narg - 3);
  region_id = arg[3];
  Region *region = domain->get_region_by_id(region_id);
  if (!region) error->all(FLERR, 3, "fix mdanim/liquid: there is no region {}; make it before this fix", arg[3]);
  if (strcmp(region->style, "block") != 0 || !region->interior || region->dynamic_check() || !region->bboxflag)
    error->all(FLERR, 3, "fix mdanim/liquid: the basin must be a finite, resting region of style block, side in; {} is not",
               arg[3]);
  const double rho = utils::numeric(FLERR, arg[4], false, lmp);
  if (!(rho > 0.0)) error->all(FLERR, 4, "fix mdanim/liquid: density must be > 0, got {}", arg[4]);
  buoyancy = std::make_unique<Buoyancy>(lmp, rho);
  if (strcmp(arg[5], "grid") != 0)
    error->all(FLERR, 5, "fix mdanim/liquid: expected grid NX NY NZ after the density, got {}", arg[5]);
  int n[3];
  for (int d = 0; d < 3; ++d) {
    n[d] = utils::inumeric(FLERR, arg[6 + d], false, lmp);
    if (n[d] < 1) error->all(FLERR, 6 + d, "fix mdanim/liquid: grid must be >= 1 along every axis, got {}", arg[6 + d]);
  }

  bool has_volume = false;
  double g = -1.0;
  bigint seed = 1;
  Vertical vertical = Vertical::LOWER;
  double calm = 0.0, spray = 0.0;
  std::vector<int> makers;    // positions of the words of each
  Basin::Pace pace;
  std::vector<Keyword> known = FIXED;
  known.insert(known.end(), FREE.begin(), FREE.end());
  for (int iarg = 9; iarg < narg;) {
    const int used = words_of_keyword(lmp, STYLE, known, iarg, narg, arg);
    const char *word = arg[iarg], *value = arg[iarg + 1];
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
      else if (strcmp(value, "waves") == 0)
        model = Model::WAVES;
      else
        error->all(FLERR, iarg + 1, "fix mdanim/liquid: model must be surface, paper or waves, got {}", value);
    } else if (strcmp(word, "calm") == 0) {
      calm = utils::numeric(FLERR, value, false, lmp);
      if (!(calm > 0.0)) error->all(FLERR, iarg + 1, "fix mdanim/liquid: calm must be > 0, got {}", value);
    } else if (strcmp(word, "drops") == 0) {
      spray = utils::numeric(FLERR, value, false, lmp);
      if (!(spray >= 0.0 && spray <= 1.0))
        error->all(FLERR, iarg + 1, "fix mdanim/liquid: drops must be a share from 0 to 1, got {}", value);
    } else if (is_maker(word)) {
      makers.push_back(iarg);
    } else if (strcmp(word, "vertical") == 0) {
      if (strcmp(value, "lower") == 0)
        vertical = Vertical::LOWER;
      else if (strcmp(value, "any") == 0)
        vertical = Vertical::ANY;
      else
        error->all(FLERR, iarg + 1, "fix mdanim/liquid: vertical must be lower or any, got {}", value);
    } else if (strcmp(word, "seed") == 0) {
      seed = utils::bnumeric(FLERR, value, false, lmp);
    } else
      keyword(iarg, arg, pace);
    iarg += used;
  }
  if (has_volume == has_level)
    error->all(FLERR, "fix mdanim/liquid: write either volume V or level Z, {}", has_level ? "not both" : "one of them");
  if (g < 0.0) error->all(FLERR, "fix mdanim/liquid: gravity G is missing; liquid lies flat only under gravity along -z");

  const Vec3 low = {region->extent_xlo, region->extent_ylo, region->extent_zlo};
  const Vec3 cell = {(region->extent_xhi - low.x) / n[0], (region->extent_yhi - low.y) / n[1],
                     (region->extent_zhi - low.z) / n[2]};
  if (has_level && !(level_asked > low.z && level_asked <= region->extent_zhi))
    error->all(FLERR, "fix mdanim/liquid: level {} is not within the basin, {} to {}", level_asked, low.z, region->extent_zhi);
  const Basin::Shape shape{n[0], n[1], n[2], low, cell};
  if (calm > 0.0 && model != Model::WAVES)
    error->all(FLERR, "fix mdanim/liquid: calm is for model waves; leave it out, or write model waves");
  if (spray > 0.0 && model != Model::WAVES)
    error->all(FLERR, "fix mdanim/liquid: drops is for model waves; leave it out, or write model waves");
  if (!makers.empty() && model != Model::WAVES)
    error->all(FLERR, makers[0], "fix mdanim/liquid: {} is for model waves; leave it out, or write model waves", arg[makers[0]]);
  const std::string refused = model == Model::WAVES ? WaveBasin::unusable(shape) : AutomatonBasin::too_large(n[0], n[1], n[2]);
  if (!refused.empty()) error->all(FLERR, 6, "fix mdanim/liquid: {}", refused);
  g *= force->ftm2v;    // from force/mass to an acceleration
  try {
    if (model == Model::WAVES) {
      auto waves = std::make_unique<WaveBasin>(shape, g, calm > 0.0 ? calm_rate(calm) : 0.0, spray,
                                               static_cast<std::uint64_t>(seed), sums);
      const double area = cell.x * n[0] * cell.y * n[1], depth = has_level ? level_asked - low.z : volume_asked / area;
      for (const int iarg : makers) add_maker(*waves, iarg, arg, depth);
      basin = std::move(waves);
    } else
      basin = std::make_unique<AutomatonBasin>(
          shape, g, static_cast<std::uint64_t>(seed), vertical,
          model == Model::PAPER ? AutomatonBasin::Immersion::PAPER : AutomatonBasin::Immersion::SURFACE, sums);
  } catch (const std::bad_alloc &) {
    error->one(FLERR, "fix mdanim/liquid: no memory for a grid of {:.3g} cells; use fewer, larger cells",
               1.0 * n[0] * n[1] * n[2]);
  }
  basin->pace = pace;
  size_array_rows = basin->columns();
  if (!basin->acts_on_cells()) return;
  maxexchange = sizeof(InLiquid) / sizeof(double);
  grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
}

FixMdanimLiquid::~FixMdanimLiquid()
{
  if (basin && basin->acts_on_cells()) atom->delete_callback(id, Atom::GROW);
}

// Keywords that fix_modify takes as well.
void FixMdanimLiquid::keyword(int iarg, char **arg, Basin::Pace &pace)
{
  const char *word = arg[iarg];
  const char *value = arg[iarg + 1];
  if (buoyancy->keyword(iarg, word, value)) return;
  if (strcmp(word, "cells") == 0) {
    lattice_cells = ParticleTable(lmp, "fix mdanim/liquid: cells", iarg + 1, value);
  } else if (strcmp(word, "softness") == 0) {
    softness = ParticleColumn(lmp, "fix mdanim/liquid", word, iarg + 1, value);
  } else if (strcmp(word, "still") == 0) {
    still_group = NamedGroup(lmp, STYLE, iarg + 1, value);
  } else if (strcmp(word, "sweeps") == 0) {
    pace.sweeps = strcmp(value, "auto") == 0 ? 0 : utils::inumeric(FLERR, value, false, lmp);
    if (strcmp(value, "auto") != 0 && (pace.sweeps < 1 || pace.sweeps > Basin::MOST_SWEEPS))
      error->all(FLERR, iarg + 1, "fix mdanim/liquid: sweeps must be auto or 1 to {}, got {}", Basin::MOST_SWEEPS, value);
  } else if (strcmp(word, "stride") == 0 || strcmp(word, "period") == 0) {
    double &number = strcmp(word, "stride") == 0 ? pace.stride : pace.period;
    number = utils::numeric(FLERR, value, false, lmp);
    if (!(number > 0.0)) error->all(FLERR, iarg + 1, "fix mdanim/liquid: {} must be > 0, got {}", word, value);
  } else {
    pace.every = utils::inumeric(FLERR, value, false, lmp);
    if (pace.every < 1) error->all(FLERR, iarg + 1, "fix mdanim/liquid: every must be >= 1, got {}", value);
  }
}

int FixMdanimLiquid::modify_param(int narg, char **arg)
{
  const int used = words_of_keyword(lmp, STYLE, FREE, 0, narg, arg);
  keyword(0, arg, basin->pace);
  static const char *const OF_STEPS[] = {"buoyancy", "drag",  "quadratic", "lambda", "base",
                                         "sweeps",   "every", "stride",    "period"};
  changed_since_setup = changed_since_setup || std::none_of(std::begin(OF_STEPS), std::end(OF_STEPS),
                                                            [&](const char *w) { return strcmp(w, arg[0]) == 0; });
  return used;
}

int FixMdanimLiquid::setmask() { return POST_NEIGHBOR | POST_FORCE | END_OF_STEP; }

void FixMdanimLiquid::init()
{
  if (model == Model::WAVES) need(OBJECTS);
  if (lattice_cells.given()) need(ATOM_MAP);
  FixBase::init();
  buoyancy->init(name());
  if (model == Model::WAVES && !lattice_cells.given())
    error->all(FLERR, "{}: model waves needs the lattice cells of solids; add cells i2_NAME, or write model surface", name());
  const int width = lattice_cells.given() ? lattice_cells.width(lmp) : 7;
  if (width != 7 && width != 8)
    error->all(
        FLERR,
        "{}: cells names i2_{}, which is not a property of 7 integers, or 8 with the layers of cells around it; make it with "
        "'fix ID all property/atom i2_{} 7 ghost yes'",
        name(), lattice_cells.name, lattice_cells.name);
  if (lattice_cells.given() && comm->nprocs > 1 && !lattice_cells.ghosts_have_rows(lmp))
    error->all(FLERR,
               "{}: ghosts have no rows of i2_{}, which cells needs on several ranks; add 'ghost yes' to its fix property/atom",
               name(), lattice_cells.name);
  use(Threads());    // until passes tell how many there are
}

// --- the liquid ---

// Calls a function of the basin, which may find no room for liquid.
template <class Work> void FixMdanimLiquid::in_basin(Work &&work)
{
  try {
    work();
  } catch (const std::runtime_error &problem) {
    error->all(FLERR, "{}: {}", name(), problem.what());
  }
}

void FixMdanimLiquid::pour()
{
  basin->mark_moving(bodies(false));
  const Basin::Shape &shape = basin->shape;
  const Vec3 &low = shape.low, &cell = shape.cell;
  std::vector<std::uint8_t> within(static_cast<std::size_t>(shape.nx) * shape.ny * shape.nz, 1);
  if (!fill_id.empty()) {
    Region *fill = domain->get_region_by_id(fill_id);
    if (!fill) error->all(FLERR, "{}: region {} has been deleted", name(), fill_id);
    fill->prematch();
    CellBox{{0, 0, 0}, {shape.nx, shape.ny, shape.nz}}.each([&](int x, int y, int z) {
      within[basin->cell_number(x, y, z)] =
          fill->match(low.x + (x + 0.5) * cell.x, low.y + (y + 0.5) * cell.y, low.z + (z + 0.5) * cell.z);
    });
  }
  const Basin::Amount amount{has_level, has_level ? level_asked : volume_asked, !fill_id.empty()};
  const Basin::Filled filled = basin->fill(amount, within, static_cast<std::uint64_t>(update->ntimestep));
  if (filled.wanted < 1)
    error->all(FLERR, "{}: {} is less than half a cell of liquid; use more liquid or smaller cells", name(),
               has_level ? fmt::format("level {}", level_asked) : fmt::format("volume {}", volume_asked));
  if (filled.left)
    error->all(FLERR, "{}: {} of {} cells of liquid find no room beside the solids in {}; use less liquid or a larger basin",
               name(), filled.left, filled.wanted, fill_id.empty() ? "the basin" : "the region to fill");
}

// Decided once for a step, and again after the update.
bool FixMdanimLiquid::is_due()
{
  if (update->ntimestep % basin->pace.every != 0) return false;
  if (asked != update->ntimestep) due_then = basin->is_due(fastest_near(), update->dt, update->ntimestep);
  asked = update->ntimestep;
  return due_then;
}

// Square of the speed of the fastest solid near the liquid; -1 without any.
double FixMdanimLiquid::fastest_near()
{
  if (none_near) return -1.0;
  const Lap lap(look_seconds);
  double fastest = fastest_in_arrays(in_arrays());
  if (is_split) fastest = std::max(fastest, fastest_in_passes);
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, &fastest, 1, MPI_DOUBLE, MPI_MAX, world);
  return fastest;
}

void FixMdanimLiquid::update_liquid()
{
  buoyancy->give_impulses(*basin, near);
  in_basin([&] { basin->update(bodies_near(), static_cast<std::uint64_t>(update->ntimestep)); });
  if (top_height(basin->top()) > listed_top) {
    find_near(neighbor->skin);    // a particle that has gone one way since lists were made may go as far the other way
    lowest = -ANYWHERE;           // unknown in that case
  }
  buoyancy->look(*basin, near);
  due_then = false;
}

double FixMdanimLiquid::top_height(double cells) const { return basin->shape.low.z + cells * basin->shape.cell.z; }

// --- solids in the liquid ---

void FixMdanimLiquid::setup_post_neighbor()
{
  for (int i = 0; model == Model::WAVES && i < atom->nlocal; ++i)
    if (atom->mask[i] & groupbit) need_object(this, lmp, i, LEFT_OUT);
  const long changed = basin->mark_still(bodies(true));
  if (!basin->is_poured())
    pour();
  else if (changed)    // solids that never move have been moved between two runs
    in_basin([&] { basin->settle(static_cast<std::uint64_t>(update->ntimestep)); });
  changed_since_setup = false;
  none_near = false;    // between two runs anything may have been changed
  is_split = false;     // it may be true when an error has broken off passes
  buoyancy->forget_cells();
  asked = -1;
  post_neighbor();
}

void FixMdanimLiquid::post_neighbor()
{
  const Lap lap(look_seconds);
  find_near(0.5 * neighbor->skin);
}

// Particles that can come near the liquid before they have moved by `margin`. No other particle has friction from it.
void FixMdanimLiquid::find_near(double margin)
{
  near.clear();
  ++lists;
  near_marks.assign(atom->nlocal, 0);
  listed_top = top_height(basin->top());
  const double below = lists_are_prompt() ? listed_top + Basin::NEAR * basin->shape.cell.z + margin : ANYWHERE;
  // The box holds all particles as they stood at the last rebuild: where none was near, and the whole box is above, none has
  // come.
  lowest = domain->boxlo[2];
  if (none_near && lists_are_prompt() && lowest > below + 0.5 * neighbor->skin) return buoyancy->forget_cells();
  lowest = ANYWHERE;
  buoyancy->clear_friction(groupbit);
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit) || atom->mask[i] & still_group.bit()) continue;
    lowest = std::min(lowest, atom->x[i][2]);
    if (atom->x[i][2] >= below) continue;
    if (model == Model::WAVES) need_object(this, lmp, i, LEFT_OUT);
    near.push_back(i);
    near_marks[i] = 1;
  }
  if (by_cells()) buoyancy->find_cells(near, lattice_cells, name());
  int here = !near.empty(), any = here;
  if (comm->nprocs > 1) MPI_Allreduce(&here, &any, 1, MPI_INT, MPI_MAX, world);
  none_near = !any;
}

void FixMdanimLiquid::setup(int)
{
  if (!has_looked) buoyancy->look(*basin, near);
  has_looked = true;
  buoyancy->act(*basin, near, false);
  buoyancy->begin_ledger();
}

void FixMdanimLiquid::post_force(int)
{
  need_setup();
  if (is_due()) update_liquid();
  buoyancy->act(*basin, in_arrays(), true);
}

void FixMdanimLiquid::end_of_step() { buoyancy->go_on_with_ledger(); }

// --- output ---

double FixMdanimLiquid::compute_scalar() { return -buoyancy->ledger().sum.work; }

void FixMdanimLiquid::tell_numbers()
{
  const auto along = [this](Vec3 Basin::Impulses::*which, double Vec3::*axis) {
    return [this, which, axis] { return buoyancy->density() * (basin->impulses().*which).*axis; };
  };
  const auto coupling = [this] { return look_seconds + buoyancy->seconds; };
  tell({{"cells", false, [this] { return basin->cells_now(); }},
        {"cells_at_start", false, [this] { return basin->cells_at_start(); }},
        {"level", false, [this] { return basin->mean_level(); }},
        {"solid_cells", false, [this] { return static_cast<double>(basin->solid_cells()); }},
        {"updates", false, [this] { return static_cast<double>(basin->updates_so_far()); }},
        {"awake", false, [this] { return static_cast<double>(!(basin->is_calm() && none_near)); }},
        {"drag_loss", false, [this] { return buoyancy->ledger().sum.lost; }},
        {"flow_seconds", false, [this] { return largest(basin->liquid_seconds); }},
        {"occupancy_seconds", false, [this] { return largest(basin->occupancy_seconds); }},
        {"coupling_seconds", false, [=] { return largest(coupling()); }},
        {"seconds", false, [=] { return largest(basin->liquid_seconds + basin->occupancy_seconds + coupling()); }},
        {"waves", false,
         [this] {
           return basin->energy() * buoyancy->density() * buoyancy->weight(*basin) * basin->cell_volume() * basin->shape.cell.z;
         }},
        {"crest", false, [this] { return top_height(basin->highest()); }},
        {"momentum_x", false, [this] { return buoyancy->density() * basin->momentum().x; }},
        {"momentum_y", false, [this] { return buoyancy->density() * basin->momentum().y; }},
        {"basin_impulse_x", false, along(&Basin::Impulses::basin, &Vec3::x)},
        {"basin_impulse_y", false, along(&Basin::Impulses::basin, &Vec3::y)},
        {"solid_impulse_x", false, along(&Basin::Impulses::solids, &Vec3::x)},
        {"solid_impulse_y", false, along(&Basin::Impulses::solids, &Vec3::y)},
        {"came_x", false, along(&Basin::Impulses::came, &Vec3::x)},
        {"came_y", false, along(&Basin::Impulses::came, &Vec3::y)},
        {"clock", false, [this] { return basin->clock(update->ntimestep, update->dt); }}});
}

// A row per column of cells: x, y of its centre, z of the smooth surface, z of the topmost liquid (NaN where a body hides it).
double FixMdanimLiquid::compute_array(int row, int column)
{
  const Basin::Shape &shape = basin->shape;
  switch (column) {
    case 0:
      return shape.low.x + (row % shape.nx + 0.5) * shape.cell.x;
    case 1:
      return shape.low.y + (row / shape.nx + 0.5) * shape.cell.y;
    case 2:
      return basin->smooth_height(row);
    default:
      return basin->raw_height(row);
  }
}

double FixMdanimLiquid::memory_usage()
{ return basin->bytes() + static_cast<double>(near.capacity() * sizeof(int) + slabs.bytes()) + buoyancy->bytes(); }
