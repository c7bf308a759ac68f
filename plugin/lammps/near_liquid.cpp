// SPDX-License-Identifier: GPL-2.0-only
// Loops over particles.

#include "lammps/near_liquid.h"

#include "numbers/vec3.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "neighbor.h"

#include <algorithm>

namespace mdanim {

static constexpr double ANYWHERE = std::numeric_limits<double>::infinity();

bool NearLiquid::find(const Basin &basin, int group, int still, double margin, bool prompt)
{
  near.clear();
  ++lists;
  near_marks.assign(atom->nlocal, 0);
  listed_top = basin.height(basin.top());
  const double below = prompt ? listed_top + Basin::NEAR * basin.shape.cell.z + margin : ANYWHERE;
  // The box holds all particles as they stood at the last rebuild: where none was near, and the whole box is above, none has
  // come.
  lowest = domain->boxlo[2];
  if (none_anywhere && prompt && lowest > below + 0.5 * neighbor->skin) return false;
  lowest = ANYWHERE;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & group) || atom->mask[i] & still) continue;
    lowest = std::min(lowest, atom->x[i][2]);
    if (atom->x[i][2] >= below) continue;
    near.push_back(i);
    near_marks[i] = 1;
  }
  int here = !near.empty(), any = here;
  if (comm->nprocs > 1) MPI_Allreduce(&here, &any, 1, MPI_INT, MPI_MAX, world);
  none_anywhere = !any;
  return true;
}

void NearLiquid::split(const std::vector<int> *in_arrays, const Basin &basin)
{
  is_split = in_arrays;
  if (!is_split) return;
  near_in_arrays.clear();
  for (const int i : *in_arrays)
    if (near_marks[i]) near_in_arrays.push_back(i);
  fastest_in_passes = fastest_of(near, basin);
}

double NearLiquid::fastest(const Basin &basin) const
{
  double fastest = fastest_of(in_arrays(), basin);
  if (is_split) fastest = std::max(fastest, fastest_in_passes);
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, &fastest, 1, MPI_DOUBLE, MPI_MAX, world);
  return fastest;
}

double NearLiquid::fastest_of(const std::vector<int> &these, const Basin &basin) const
{
  double fastest = -1.0;
  const double *const *x = atom->x, *const *v = atom->v;
  const double below = top_of_near(basin);
  for (const int i : these)
    if (x[i][2] < below) {
      const Vec3 relative = vec3(v[i]) - basin.velocity();
      fastest = std::max(fastest, dot(relative, relative));
    }
  return fastest;
}

}    // namespace mdanim
