// SPDX-License-Identifier: GPL-2.0-only
// The order of what happens in a run, and output.

#include "lammps/fix_mdanim_liquid.h"
#include "lammps/object_table.h"

#include "numbers/stopwatch.h"

#include "atom.h"
#include "error.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <stdexcept>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static const char *const LEFT_OUT = ", or leave it out of the group of this fix";

// --- the command ---

FixMdanimLiquid::FixMdanimLiquid(LAMMPS *lmp, int narg, char **arg)
    : FixBase(lmp, narg, arg), sums(lmp), command(lmp, narg, arg), buoyancy(lmp, command.density),
      solids(lmp, groupbit, buoyancy), near(lmp), moving(lmp)
{
  array_flag = 1;
  size_array_cols = 4;
  extarray = 0;
  nevery = 1;
  restart_global = 1;
  need(THREE_DIMENSIONS | ORTHOGONAL_BOX | OPEN_BOX);
  look_up({&solids.still_group, &solids.driven_group}, {});
  tell_numbers();
  std::vector<Keyword> known = free_keywords();
  known.push_back({"moving", "FIXID", "", [this](int at, char **arg) { moving.add(0, arg[at + 1]); }});
  command.read_keywords(known, narg, arg);
  basin = command.make_basin(sums, arg);
  if (moving.any() && !basin->can_move())
    error->all(FLERR, "{}: moving is for model waves; other liquids have no momentum, and would stay behind", name());
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
std::vector<Keyword> FixMdanimLiquid::free_keywords()
{
  std::vector<Keyword> all = buoyancy.keywords();
  for (const std::vector<Keyword> &more : {solids.keywords(changed_since_setup), command.pace_keywords()})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

int FixMdanimLiquid::modify_param(int narg, char **arg)
{
  const int used = take_keyword(lmp, LiquidCommand::STYLE, free_keywords(), 0, narg, arg);
  basin->pace = command.pace;
  return used;
}

int FixMdanimLiquid::setmask() { return POST_NEIGHBOR | POST_FORCE | END_OF_STEP; }

void FixMdanimLiquid::init()
{
  if (makes_waves()) need(OBJECTS);
  if (solids.lattice_cells().given()) need(ATOM_MAP);
  FixBase::init();
  moving.init(name());
  buoyancy.init(name());
  buoyancy.driven = solids.driven_group.bit();
  solids.none_is_still = moving.any();
  buoyancy.standing = moving.any() ? solids.still_group.bit() : 0;
  if (makes_waves() && !solids.lattice_cells().given())
    error->all(FLERR, "{}: model waves needs the lattice cells of solids; add cells i2_NAME, or write model surface", name());
  solids.init(command.model == LiquidCommand::Model::PAPER, name());
  use(Threads());    // until passes tell how many there are
}

void FixMdanimLiquid::use(const Threads &now)
{
  basin->use(now);
  buoyancy.use(now);
  solids.use(now);
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
  basin->mark_moving(solids.bodies(*basin, false));
  const Basin::Filled filled =
      basin->fill(command.amount(), command.cells_to_fill(*basin, name()), static_cast<std::uint64_t>(update->ntimestep));
  if (filled.wanted < 1)
    error->all(FLERR, "{}: {} is less than half a cell of liquid; use more liquid or smaller cells", name(),
               command.amount_in_words());
  if (filled.left)
    error->all(FLERR, "{}: {} of {} cells of liquid find no room beside the solids in {}; use less liquid or a larger basin",
               name(), filled.left, filled.wanted, command.place_in_words());
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
  // A solid that stands in a basin that moves is as fast as the basin, wherever it is.
  const double least = moving.any() ? dot(basin->velocity(), basin->velocity()) : -1.0;
  if (near.none()) return least;
  const Lap lap(look_seconds);
  return std::max(least, near.fastest(*basin));
}

void FixMdanimLiquid::update_liquid()
{
  const double since = basin->since_update();
  if (moving.any() && since > 0.0) basin->accelerate((1.0 / since) * (basin->velocity() - moving.velocity(since)));
  buoyancy.give_impulses(*basin, near.all());
  in_basin([&] { basin->update(solids.bodies_near(*basin, near.all()), static_cast<std::uint64_t>(update->ntimestep)); });
  if (near.outgrown(*basin)) {
    find_near(neighbor->skin);    // a particle that has gone one way since lists were made may go as far the other way
    near.forget_lowest();         // unknown in that case
  }
  buoyancy.look(*basin, near.all());
  due_then = false;
}

// --- solids in the liquid ---

// To where the basin is in this step.
void FixMdanimLiquid::move_basin()
{
  if (moving.any()) basin->move_to(moving.place(), moving.velocity(0.0));
}

void FixMdanimLiquid::setup_post_neighbor()
{
  move_basin();
  for (int i = 0; makes_waves() && i < atom->nlocal; ++i)
    if (atom->mask[i] & groupbit) need_object(this, lmp, i, LEFT_OUT);
  const long changed = basin->mark_still(solids.bodies(*basin, true));
  if (!basin->is_poured())
    pour();
  else if (changed)    // solids that never move have been moved between two runs
    in_basin([&] { basin->settle(static_cast<std::uint64_t>(update->ntimestep)); });
  changed_since_setup = false;
  near.forget();
  buoyancy.forget_cells();
  asked = -1;
  post_neighbor();
}

void FixMdanimLiquid::post_neighbor()
{
  const Lap lap(look_seconds);
  find_near(0.5 * neighbor->skin);
}

// No particle that is not near has friction from the liquid.
void FixMdanimLiquid::find_near(double margin)
{
  if (!near.find(*basin, groupbit, moving.any() ? 0 : solids.still_group.bit(), margin, lists_are_prompt()))
    return buoyancy.forget_cells();
  buoyancy.clear_friction(groupbit);
  for (const int i : near.all())
    if (makes_waves()) need_object(this, lmp, i, LEFT_OUT);
  if (solids.by_cells()) buoyancy.find_cells(near.all(), solids.lattice_cells(), name());
}

void FixMdanimLiquid::setup(int)
{
  if (!has_looked) buoyancy.look(*basin, near.all());
  has_looked = true;
  buoyancy.act(*basin, near.all(), false);
  buoyancy.begin_ledger();
}

void FixMdanimLiquid::post_force(int)
{
  need_setup();
  move_basin();
  if (is_due()) update_liquid();
  buoyancy.act(*basin, near.in_arrays(), true);
}

void FixMdanimLiquid::end_of_step() { buoyancy.go_on_with_ledger(); }

// --- passes of run_style verlet/mdanim ---

// Settings that only steps read may change without a setup; those of solids may not.
void FixMdanimLiquid::need_setup() const
{
  if (changed_since_setup)
    error->all(FLERR, "{}: fix_modify has changed what the setup of a run reads; leave out 'pre no' of this run", name());
}

void FixMdanimLiquid::append_required_atoms(std::vector<int> &particles) const
{
  if (!in_passes) particles.insert(particles.end(), near.all().begin(), near.all().end());
}

bool FixMdanimLiquid::join(PassCrew &crew)
{
  need_setup();
  in_passes = false;
  if (!crew.liquid) crew.liquid = this;
  return PassParticipant::join(crew);
}

bool FixMdanimLiquid::joins(const PassIntegrator &integrator)
{
  in_passes = buoyancy.acts_in_passes(integrator.friction() != Friction::NONE, integrator.friction_of_particles());
  return in_passes;
}

void FixMdanimLiquid::acted(double work, double lost, double fastest, double seconds)
{
  buoyancy.add_power({work, lost}, seconds);
  near.moved_in_passes(fastest);
}

// An update needs all bodies. With passes that act in the liquid it comes before them.
bool FixMdanimLiquid::needs_all_atoms() { return !in_passes && is_due(); }

// While the liquid is level and no particle is near it.
double FixMdanimLiquid::safe_displacement() const
{
  const bool asleep = near.none() && basin->is_calm() && basin->moving_solid() == 0;
  return lists_are_prompt() && asleep ? near.clearance(*basin) : 0.0;
}

// --- output ---

double FixMdanimLiquid::compute_scalar() { return -buoyancy.ledger().sum.work; }

void FixMdanimLiquid::tell_numbers()
{
  const auto along = [this](Vec3 Basin::Impulses::*which, double Vec3::*axis) {
    return [this, which, axis] { return buoyancy.density() * (basin->impulses().*which).*axis; };
  };
  const auto coupling = [this] { return look_seconds + buoyancy.seconds; };
  tell({{"cells", false, [this] { return basin->cells_now(); }},
        {"cells_at_start", false, [this] { return basin->cells_at_start(); }},
        {"level", false, [this] { return basin->mean_level(); }},
        {"solid_cells", false, [this] { return static_cast<double>(basin->solid_cells()); }},
        {"updates", false, [this] { return static_cast<double>(basin->updates_so_far()); }},
        {"awake", false, [this] { return static_cast<double>(!(basin->is_calm() && near.none())); }},
        {"drag_loss", false, [this] { return buoyancy.ledger().sum.lost; }},
        {"flow_seconds", false, [this] { return largest(basin->liquid_seconds); }},
        {"occupancy_seconds", false, [this] { return largest(basin->occupancy_seconds); }},
        {"coupling_seconds", false, [=] { return largest(coupling()); }},
        {"seconds", false, [=] { return largest(basin->liquid_seconds + basin->occupancy_seconds + coupling()); }},
        {"waves", false,
         [this] {
           return basin->energy() * buoyancy.density() * buoyancy.weight(*basin) * basin->cell_volume() * basin->shape.cell.z;
         }},
        {"crest", false, [this] { return basin->height(basin->highest()); }},
        {"momentum_x", false, [this] { return buoyancy.density() * basin->momentum().x; }},
        {"momentum_y", false, [this] { return buoyancy.density() * basin->momentum().y; }},
        {"basin_impulse_x", false, along(&Basin::Impulses::basin, &Vec3::x)},
        {"basin_impulse_y", false, along(&Basin::Impulses::basin, &Vec3::y)},
        {"solid_impulse_x", false, along(&Basin::Impulses::solids, &Vec3::x)},
        {"solid_impulse_y", false, along(&Basin::Impulses::solids, &Vec3::y)},
        {"came_x", false, along(&Basin::Impulses::came, &Vec3::x)},
        {"came_y", false, along(&Basin::Impulses::came, &Vec3::y)},
        {"clock", false, [this] { return basin->clock(update->ntimestep, update->dt); }},
        {"way_x", false, [this] { return basin->way().x; }},
        {"way_y", false, [this] { return basin->way().y; }},
        {"outer", false, [this] { return buoyancy.density() * basin->impulses().outer; }},
        {"work", false, [this] { return buoyancy.density() * (basin->impulses().outer - outer_before); }}});
}

// A row per column of cells: x, y of its centre, z of the smooth surface, z of the topmost liquid (NaN where a body hides it).
double FixMdanimLiquid::compute_array(int row, int column)
{
  const Basin::Shape &shape = basin->shape;
  switch (column) {
    case 0:
      return basin->low().x + (row % shape.nx + 0.5) * shape.cell.x;
    case 1:
      return basin->low().y + (row / shape.nx + 0.5) * shape.cell.y;
    case 2:
      return basin->smooth_height(row);
    default:
      return basin->raw_height(row);
  }
}

double FixMdanimLiquid::memory_usage()
{ return basin->bytes() + static_cast<double>(near.bytes() + solids.bytes()) + buoyancy.bytes(); }
