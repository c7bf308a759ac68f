// SPDX-License-Identifier: GPL-2.0-only

#include "lammps/spring_losses.h"

#include "lammps/particle_value.h"

#include "atom.h"
#include "force.h"
#include "update.h"

namespace mdanim {

void SpringLosses::count(int i, int j, const LoadFree &spring, double sign)
{
  if (i >= atom->nlocal) return;
  if (less.empty()) less.resize(atom->nlocal);
  const Vec3 way = update->dt * vec3(atom->v[i]), apart = vec3(atom->x[i]) - vec3(atom->x[j]);
  const Vec3 before = apart - (way - update->dt * vec3(atom->v[j]));
  lost += sign * lost_with(spring, apart, before, way);
  less[i] += sign * force_of(spring.spring, apart);
}

void SpringLosses::count(int i, double energy, const Vec3 &now, const Vec3 &then)
{
  if (i >= atom->nlocal) return;
  if (less.empty()) less.resize(atom->nlocal);
  lost += energy + work_of(now, then, update->dt * vec3(atom->v[i]));
  less[i] += now;
}

void SpringLosses::close(int groupbit)
{
  for (std::size_t i = 0; i < less.size(); ++i) {
    if (!(atom->mask[i] & groupbit) || dot(less[i], less[i]) == 0.0) continue;
    const double inertia = mass_of(atom->rmass, atom->mass, atom->type, static_cast<int>(i)) / force->ftm2v;
    lost += lost_with_kick(vec3(atom->f[i]), less[i], inertia, update->dt);
  }
  less.clear();
}

}    // namespace mdanim
