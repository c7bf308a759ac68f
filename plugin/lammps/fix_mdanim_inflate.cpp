// SPDX-License-Identifier: GPL-2.0-only

#include "lammps/fix_mdanim_inflate.h"

#include "lammps/shared_file.h"
#include "numbers/stopwatch.h"

#include "atom.h"
#include "error.h"
#include "force.h"

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
  tell({clock()});
  if (narg != 5 || strcmp(arg[3], "bags") != 0) error->all(FLERR, "{}: write fix ID group mdanim/inflate bags FILE", STYLE);
  try {
    for (auto &[molecule, bag] : read_bags(arg[4], read_shared_file(lmp, STYLE, "bags", arg[4]))) {
      nodes.append(molecule, bag.surface->nodes());
      objects.push_back({bag, bag.gas.start, 0.0});
    }
  } catch (const std::runtime_error &wrong) {
    error->all(FLERR, "{}: {}", STYLE, wrong.what());
  }
  if (objects.empty()) error->all(FLERR, "{}: there is no object in {}; write object M P V P0 and its triangles", STYLE, arg[4]);
  size_array_rows = static_cast<int>(objects.size());
}

int FixMdanimInflate::setmask() { return PRE_NEIGHBOR | POST_FORCE; }

void FixMdanimInflate::init()
{
  FixBase::init();
  nodes.find(name());
}

void FixMdanimInflate::push()
{
  const double units = force->nktv2p;    // of pressure: energy/distance^3 times nktv2p
  nodes.share();
  for (int n = 0; n < nodes.count(); ++n) {
    if (!nodes.acts(n)) continue;
    InflatedObject &one = objects[n];
    const std::size_t first = nodes.first(n), count = nodes.end(n) - first;
    x.resize(count);
    for (std::size_t k = 0; k < count; ++k) x[k] = nodes.place(first + k);
    one.volume = one.bag.surface->volume(x);
    if (!(one.volume > 0.0))
      error->all(FLERR, "{}: object {} (molecule ID) has been pressed until its volume was {}, and gas needs room", name(),
                 nodes.molecule(n), one.volume);
    one.pressure = one.bag.gas.pressure(one.volume);
    one.bag.surface->find_areas(x, areas);
    for (std::size_t k = 0; k < count; ++k)
      if (const int i = nodes.target(first + k); i != ObjectNodes::ELSEWHERE)
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
    if (nodes.acts(n)) all += objects[n].bag.gas.energy(objects[n].volume);
  return all / force->nktv2p;
}

double FixMdanimInflate::compute_array(int n, int column) { return column == 0 ? objects[n].volume : objects[n].pressure; }

double FixMdanimInflate::memory_usage() { return static_cast<double>(nodes.bytes()); }
