// SPDX-License-Identifier: GPL-2.0-only
// The table of needs, and reductions.

#include "lammps/fix_base.h"

#include "lammps/object_table.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "fmt/format.h"
#include "lammps.h"
#include "neighbor.h"
#include "update.h"
#include "utils.h"

#include <utility>

using namespace LAMMPS_NS;

namespace mdanim {

namespace {

struct Refusal {
  unsigned need;    // 0: every fix has it
  bool (*is_met)(const LAMMPS &);
  const char *why;    // {}: stands for `missed`
};

bool is_open(const Domain &box) { return !(box.xperiodic || box.yperiodic || box.zperiodic); }

bool is_prompt(const Neighbor &lists) { return lists.every == 1 && lists.delay == 0 && !lists.build_once; }

const Refusal REFUSALS[] = {
    {0, [](const LAMMPS &lmp) { return !utils::strmatch(lmp.update->integrate_style, "^respa"); },
     "run_style respa is not supported; use run_style verlet"},
    {THREE_DIMENSIONS, [](const LAMMPS &lmp) { return lmp.domain->dimension == 3; },
     "the box has 2 dimensions, 3 are needed; use 'dimension 3'"},
    {ORTHOGONAL_BOX, [](const LAMMPS &lmp) { return !lmp.domain->triclinic; }, "the box is triclinic; use an orthogonal one"},
    {OPEN_BOX, [](const LAMMPS &lmp) { return is_open(*lmp.domain); },
     "the box is periodic; put 'boundary s s s' (or f) before the box is made"},
    {OBJECTS, [](const LAMMPS &lmp) { return lmp.atom->molecule_flag != 0; }, NO_OBJECTS},
    {ATOM_MAP, [](const LAMMPS &lmp) { return lmp.atom->map_style != Atom::MAP_NONE; },
     "needs an atom map; put 'atom_modify map array' before the box is made"},
    {PROMPT_LISTS, [](const LAMMPS &lmp) { return is_prompt(*lmp.neighbor); },
     "{} between two rebuilds; use 'neigh_modify every 1 delay 0 check yes once no'"},
};

}    // namespace

FixBase::FixBase(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  scalar_flag = 1;
  extscalar = 1;
  energy_global_flag = 1;
  global_freq = 1;
}

bool FixBase::lists_are_prompt() const { return is_prompt(*neighbor); }

std::string FixBase::name() const { return fmt::format("fix {} {}", id, style); }

void FixBase::need(unsigned more, const std::string &what)
{
  needs |= more;
  if (!what.empty()) missed = what;
}

void FixBase::look_up(std::vector<NamedGroup *> these, std::vector<ParticleValue *> and_these)
{
  groups = std::move(these);
  values = std::move(and_these);
}

void FixBase::tell(std::vector<Output> outputs)
{
  numbers = std::move(outputs);
  for (const Output &one : numbers) extensive.push_back(one.extensive);
  vector_flag = 1;
  size_vector = static_cast<int>(numbers.size());
  extvector = -1;
  extlist = extensive.data();
}

void FixBase::init()
{
  for (const Refusal &one : REFUSALS)
    if ((one.need & needs) == one.need && !one.is_met(*lmp))
      error->all(FLERR, "{}: {}", name(), fmt::format(fmt::runtime(one.why), missed));
  for (NamedGroup *group : groups) group->init(lmp);
  for (ParticleValue *value : values) value->init(lmp);
}

double FixBase::reduced(double here, MPI_Op operation) const
{
  MPI_Allreduce(MPI_IN_PLACE, &here, 1, MPI_DOUBLE, operation, world);
  return here;
}

Output FixBase::clock()
{
  return {"seconds", false, [this] { return largest(seconds); }};
}

}    // namespace mdanim
