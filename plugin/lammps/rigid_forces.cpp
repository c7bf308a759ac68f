// SPDX-License-Identifier: GPL-2.0-only

#include "lammps/rigid_forces.h"

#include "atom.h"
#include "comm.h"
#include "lammps.h"

#include <algorithm>
#include <cstddef>

namespace mdanim {

const RigidForces::Sums &RigidForces::find()
{
  look();
  const double *const *const f = lmp->atom->f, *const *const x = lmp->atom->x;
  const auto terms_of = [&](int i) {
    const Vec3 force = vec3(f[i]), torque = cross(vec3(x[i]) - bodies[particles.body_of(i)].centre, force);
    return std::array<double, 6>{force.x, force.y, force.z, torque.x, torque.y, torque.z};
  };
  Sums now = particles.sums<6>(terms_of, [this](int n) { return !as_before[n]; });
  for (std::size_t n = 0; n < now.size(); ++n)
    if (as_before[n]) now[n] = sums[n];
  sums.swap(now);
  return sums;
}

void RigidForces::look()
{
  const auto is_settled = [](const RigidBody &one) { return one.settled; };
  as_before.assign(bodies.size(), 0);
  if (lmp->comm->nprocs > 1 || std::none_of(bodies.begin(), bodies.end(), is_settled)) return forget();
  const std::size_t count = 3 * static_cast<std::size_t>(lmp->atom->nlocal);
  const bool are_known = seen.size() == count && sums.size() == bodies.size();
  seen.resize(count);
  for (std::size_t n = 0; n < bodies.size(); ++n) as_before[n] = are_known && bodies[n].settled;
  for (int i = 0; i < lmp->atom->nlocal; ++i) {
    const double *const f = lmp->atom->f[i];
    double *const known = &seen[3 * static_cast<std::size_t>(i)];
    const int body = particles.body_of(i);
    if (body != ObjectTable::NONE && (f[0] != known[0] || f[1] != known[1] || f[2] != known[2])) as_before[body] = 0;
    std::copy(f, f + 3, known);
  }
}

}    // namespace mdanim
