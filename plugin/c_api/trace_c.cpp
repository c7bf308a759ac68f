// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions for ctypes: where objects have been during the steps of a run, and how fast they are. All ranks call them
// together.

#include "c_api/abi.h"
#include "c_api/guarded.h"
#include "lammps/fix_mdanim_leapfrog.h"
#include "lammps/object_table.h"

#include "atom.h"
#include "lammps.h"
#include "modify.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

using namespace LAMMPS_NS;
using mdanim::guarded;

namespace {

// The fix that moves all particles.
FixMdanimLeapfrog *leapfrog(void *handle)
{
  const auto found = static_cast<LAMMPS *>(handle)->modify->get_fix_by_style("^mdanim/leapfrog$");
  if (found.size() != 1) throw std::runtime_error("one fix mdanim/leapfrog is needed, there are " + std::to_string(found.size()));
  return dynamic_cast<FixMdanimLeapfrog *>(found.front());
}

void trace(void *handle, int objects, double *low, double *high)
{
  const FixMdanimLeapfrog *fix = leapfrog(handle);
  if (fix->traced() != objects)
    throw std::runtime_error(std::to_string(fix->traced()) + " objects are traced, " + std::to_string(objects) +
                             " are asked for; call mdanim_trace_start before");
  const std::vector<mdanim::Box> boxes = fix->traced_boxes();
  for (int m = 0; m < objects; ++m)
    for (int d = 0; d < 3; ++d) {
      low[3 * m + d] = boxes[m].low(d);
      high[3 * m + d] = boxes[m].high(d);
    }
}

void top_speeds(void *handle, int objects, double *speed)
{
  const auto lammps = static_cast<LAMMPS *>(handle);
  const Atom &atom = *lammps->atom;
  if (!atom.molecule_flag) throw std::runtime_error(mdanim::NO_OBJECTS);
  std::fill_n(speed, objects, 0.0);
  for (int i = 0; i < atom.nlocal; ++i) {
    const tagint object = atom.molecule[i];
    if (object < 1 || object > objects) continue;
    const double *v = atom.v[i];
    speed[object - 1] = std::max(speed[object - 1], (v[0] * v[0] + v[1] * v[1]) + v[2] * v[2]);
  }
  MPI_Allreduce(MPI_IN_PLACE, speed, objects, MPI_DOUBLE, MPI_MAX, lammps->world);
  for (int m = 0; m < objects; ++m) speed[m] = std::sqrt(speed[m]);
}

}    // namespace

// Forgets the trace so far, and starts another of the places of objects 1 to `objects` (molecule IDs), now and after every step.
// Returns 0, or 1 with a message in `error`.
MDANIM_EXPORT int mdanim_trace_start(void *handle, int objects, char *error, int error_size)
{
  return guarded(error, error_size, [=] {
    if (const std::string why = leapfrog(handle)->start_trace(objects); !why.empty()) throw std::runtime_error(why);
  });
}

// Looks at particles only after every `steps` steps, until the next mdanim_trace_start. Boxes are then wider by the way of each
// object's fastest particle in one step less. Returns 0, or 1 with a message in `error`.
MDANIM_EXPORT int mdanim_trace_every(void *handle, int steps, char *error, int error_size)
{
  return guarded(error, error_size, [=] {
    if (steps < 1)
      throw std::runtime_error("a trace looks after every 1 or more steps, " + std::to_string(steps) + " are asked for");
    leapfrog(handle)->look_every(steps);
  });
}

// Lowest and highest coordinates of the particles of each object since mdanim_trace_start; low, high (objects, 3). Coordinates
// that are NaN are skipped. Returns 0, or 1 with a message in `error`.
MDANIM_EXPORT int mdanim_trace(void *handle, int objects, double *low, double *high, char *error, int error_size)
{
  return guarded(error, error_size, [=] { trace(handle, objects, low, high); });
}

// Speed of the fastest particle of each object (molecule IDs 1 to `objects`) now; speed (objects). Speeds that are NaN are
// skipped. Returns 0, or 1 with a message in `error`.
MDANIM_EXPORT int mdanim_top_speeds(void *handle, int objects, double *speed, char *error, int error_size)
{
  return guarded(error, error_size, [=] { top_speeds(handle, objects, speed); });
}
