// SPDX-License-Identifier: GPL-2.0-only

#include "lammps/fix_mdanim_inflate.h"

#include "lammps/fix_mdanim_tear.h"
#include "lammps/particle_value.h"
#include "lammps/shared_file.h"
#include "numbers/stopwatch.h"
#include "tearing/law.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "force.h"
#include "update.h"

#include <cstring>
#include <map>
#include <stdexcept>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static const char *const STYLE = "fix mdanim/inflate";
static constexpr int COLUMNS = 2;    // of compute_array()

// fix ID group mdanim/inflate bags FILE
FixMdanimInflate::FixMdanimInflate(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg), nodes(lmp)
{
  array_flag = 1;
  size_array_cols = COLUMNS;
  extarray = 0;
  need(THREE_DIMENSIONS | OPEN_BOX | OBJECTS | ATOM_MAP);
  tell({{"energy", true, [this] { return sum(lost); }}, clock()});
  if (narg != 5 || strcmp(arg[3], "bags") != 0) error->all(FLERR, "{}: write fix ID group mdanim/inflate bags FILE", STYLE);
  try {
    for (auto &[molecule, bag] : read_bags(arg[4], read_shared_file(lmp, STYLE, "bags", arg[4]))) {
      nodes.append(molecule, bag.surface->nodes());
      objects.push_back({bag, bag.gas.start, 0.0, false});
    }
  } catch (const std::runtime_error &wrong) {
    error->all(FLERR, "{}: {}", STYLE, wrong.what());
  }
  if (objects.empty()) error->all(FLERR, "{}: there is no object in {}; write object M P V P0 and its triangles", STYLE, arg[4]);
  size_array_rows = static_cast<int>(objects.size());
}

int FixMdanimInflate::setmask() { return PRE_NEIGHBOR | POST_FORCE | FINAL_INTEGRATE; }

void FixMdanimInflate::init()
{
  FixBase::init();
  nodes.find(name());
  tears = FixMdanimTear::of(lmp);
}

void FixMdanimInflate::setup(int)
{
  known = 0;
  for (InflatedObject &one : objects) one.is_open = false;
  opened();    // before this run
  push();
}

// Objects that are open from now on, the same on all ranks.
std::vector<int> FixMdanimInflate::opened()
{
  std::vector<int> found;
  for (; tears && known < tears->gone().size(); ++known)
    for (int n = 0; n < nodes.count(); ++n)
      if (nodes.molecule(n) == tears->gone()[known].object && !objects[n].is_open) {
        objects[n].is_open = true;
        found.push_back(n);
      }
  return found;
}

// Volume, pressure and areas of an object.
void FixMdanimInflate::find(int n)
{
  InflatedObject &one = objects[n];
  const std::size_t first = nodes.first(n);
  x.resize(nodes.end(n) - first);
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = nodes.place(first + k);
  one.volume = one.bag.surface->volume(x);
  if (!(one.volume > 0.0))
    error->all(FLERR, "{}: object {} (molecule ID) has been pressed until its volume was {}, and gas needs room", name(),
               nodes.molecule(n), one.volume);
  one.pressure = one.bag.gas.pressure(one.volume);
  one.bag.surface->find_areas(x, areas);
}

// Counts how much leap-frog's energy is less without the gas (tearing/law.h), with forces that hardly change in a step: U + sum
// of dt u.D/2, and the kick.
void FixMdanimInflate::let_out(int n)
{
  if (!nodes.acts(n)) return;
  find(n);
  const double units = force->nktv2p;
  if (comm->me == 0) lost += objects[n].bag.gas.energy(objects[n].volume) / units;
  for (std::size_t k = 0; k < x.size(); ++k)
    if (const int i = nodes.target(nodes.first(n) + k); i != ObjectNodes::ELSEWHERE) {
      released.emplace_back(i, (objects[n].pressure / units) * areas[k]);
      lost += 0.5 * update->dt * dot(vec3(atom->v[i]), released.back().second);
    }
}

// All forces of the step are there.
void FixMdanimInflate::final_integrate()
{
  for (const auto &[i, less] : released) {
    const double inertia = mass_of(atom->rmass, atom->mass, atom->type, i) / force->ftm2v;
    lost += lost_with_kick(vec3(atom->f[i]), less, inertia, update->dt);
  }
  released.clear();
}

void FixMdanimInflate::push()
{
  const double units = force->nktv2p;    // of pressure: energy/distance^3 times nktv2p
  nodes.share();
  for (const int n : opened()) let_out(n);
  for (int n = 0; n < nodes.count(); ++n) {
    if (!nodes.acts(n)) continue;
    InflatedObject &one = objects[n];
    if (one.is_open) {
      one.volume = one.pressure = 0.0;
      continue;
    }
    find(n);
    for (std::size_t k = 0; k < x.size(); ++k)
      if (const int i = nodes.target(nodes.first(n) + k); i != ObjectNodes::ELSEWHERE)
        add_to(atom->f[i], (one.pressure / units) * areas[k]);
  }
}

void FixMdanimInflate::post_force(int)
{
  const Lap lap(seconds);
  push();
}

double FixMdanimInflate::compute_scalar()
{
  double all = 0.0;
  for (int n = 0; n < nodes.count(); ++n)
    if (nodes.acts(n) && !objects[n].is_open) all += objects[n].bag.gas.energy(objects[n].volume);
  return all / force->nktv2p;
}

double FixMdanimInflate::compute_array(int n, int column) { return column == 0 ? objects[n].volume : objects[n].pressure; }

double FixMdanimInflate::memory_usage() { return static_cast<double>(nodes.bytes()); }
