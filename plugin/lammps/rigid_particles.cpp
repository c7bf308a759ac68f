// SPDX-License-Identifier: GPL-2.0-only

#include "lammps/rigid_particles.h"

#include "memory.h"

using namespace LAMMPS_NS;

namespace mdanim {

RigidParticles::RigidParticles(LAMMPS *lmp, const Fix &fix) : WholeObjects(lmp, fix) { grow(atom->nmax); }

RigidParticles::~RigidParticles() { memory->destroy(own_place); }

void RigidParticles::set_own(int i, const Vec3 &place)
{ own_place[i][0] = place.x, own_place[i][1] = place.y, own_place[i][2] = place.z; }

void RigidParticles::fix_places(const std::vector<RigidBody> &bodies)
{
  for (int i = 0; i < atom->nlocal; ++i) {
    if (of_particle[i] == ObjectTable::NONE) continue;
    const RigidBody &body = bodies[of_particle[i]];
    set_own(i, transposed_times(body.turn, vec3(atom->x[i]) - body.centre));
  }
}

void RigidParticles::put(const std::vector<RigidBody> &bodies, bool places, bool settled) const
{
  constexpr double NS_OF_PLACE = 10.0;
  each_particle(NS_OF_PLACE, [&](int i) {
    if (of_particle[i] == ObjectTable::NONE || !moves(i)) return;    // it may have left the group since the last lists
    const RigidBody &body = bodies[of_particle[i]];
    if (body.settled && !settled) return;
    const Vec3 from_centre = body.turn * own(i), place = body.centre + from_centre, v = body.velocity_at(from_centre);
    if (places) atom->x[i][0] = place.x, atom->x[i][1] = place.y, atom->x[i][2] = place.z;
    atom->v[i][0] = v.x, atom->v[i][1] = v.y, atom->v[i][2] = v.z;
  });
}

RigidParticles::BodyChanges RigidParticles::changes(const std::vector<RigidBody> &bodies) const
{
  const auto is_same = [](const double *a, const Vec3 &b) { return a[0] == b.x && a[1] == b.y && a[2] == b.z; };
  BodyChanges found;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (of_particle[i] == ObjectTable::NONE) continue;
    const RigidBody &body = bodies[of_particle[i]];
    const Vec3 from_centre = body.turn * own(i);
    found.moved = found.moved || !is_same(atom->x[i], body.centre + from_centre);
    found.pushed = found.pushed || !is_same(atom->v[i], body.velocity_at(from_centre));
  }
  return found;
}

double RigidParticles::bytes() const { return 3.0 * sizeof(double) * atom->nmax + WholeObjects::bytes(); }

void RigidParticles::grow(int n) { memory->grow(own_place, n, 3, "fix mdanim/rigid"); }

void RigidParticles::clear(int i) const { own_place[i][0] = own_place[i][1] = own_place[i][2] = 0.0; }

void RigidParticles::copy(int from, int to) const
{
  for (int k = 0; k < 3; ++k) own_place[to][k] = own_place[from][k];
}

int RigidParticles::pack(int i, double *buffer) const
{
  for (int k = 0; k < 3; ++k) buffer[k] = own_place[i][k];
  return 3;
}

int RigidParticles::unpack(int i, const double *buffer) const
{
  for (int k = 0; k < 3; ++k) own_place[i][k] = buffer[k];
  return 3;
}

}    // namespace mdanim
