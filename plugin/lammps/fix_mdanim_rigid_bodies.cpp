// SPDX-License-Identifier: GPL-2.0-only
// Bodies from particles: masses, moments, velocities; and what has changed between two runs.

#include "lammps/fix_mdanim_rigid.h"

#include "error.h"

using namespace LAMMPS_NS;
using namespace mdanim;

static constexpr double THIN = 1e-10;    // smallest moment over the largest of what counts as a line

// A body at rest.
static RigidBody body_of(const RigidParticles::MassProperties &found, const PrincipalAxes &axes)
{
  RigidBody body;
  body.mass = found.mass;
  body.centre = found.centre;
  body.moments = axes.moments;
  body.q = axes.q;
  body.refresh();
  return body;
}

void FixMdanimRigid::make()
{
  const std::vector<RigidParticles::MassProperties> found = particles.weigh();
  const ObjectTable &objects = particles.objects();
  bodies.resize(objects.size());
  for (int n = 0; n < objects.size(); ++n) {
    if (bodies[n].aside) continue;    // it stays as it is
    const auto other = given.find(static_cast<int>(objects.id(n)));
    const PrincipalAxes axes = principal_axes(other == given.end() ? found[n].inertia : other->second,
                                              axes_of(touching.given_shapes(), static_cast<int>(objects.id(n))));
    if (!(axes.moments.x > THIN * axes.moments.z))
      error->all(FLERR,
                 "{}: the particles of object {} (molecule ID) stand on a line, so it has no moment of inertia about it; add "
                 "'inertia FILE' with the moments of the body",
                 name(), objects.id(n));
    bodies[n] = body_of(found[n], axes);
  }
  particles.fix_places(bodies);
  set_velocities(found);
  touching.make(name(), objects, bodies);
  glue.join(name());
  sleep.tell_contact();
  // Last: glue changes velocities by roundings, and `changes` compares particles with what was put.
  particles.put(bodies, true);
}

// R diag(moments) R^T v.
static Vec3 times_moments(const Matrix3 &turn, const Vec3 &moments, const Vec3 &v)
{
  const Vec3 along = transposed_times(turn, v);
  return turn * Vec3{moments.x * along.x, moments.y * along.y, moments.z * along.z};
}

// Particles on a line have no rotation about it.
static Vec3 inverse_of(const Vec3 &moments)
{
  const auto inverse = [&](double moment) { return moment > THIN * moments.z ? 1.0 / moment : 0.0; };
  return {inverse(moments.x), inverse(moments.y), inverse(moments.z)};
}

// Velocities and angular momenta of bodies from those of their particles; of a body whose moments are given, the angular
// velocity is that of its particles.
void FixMdanimRigid::set_velocities(const std::vector<RigidParticles::MassProperties> &found)
{
  const ObjectTable &objects = particles.objects();
  const std::vector<RigidParticles::BodyMotion> motion = particles.motion(found);
  for (int n = 0; n < objects.size(); ++n) {
    RigidBody &body = bodies[n];
    if (body.aside) continue;
    body.velocity = (1.0 / found[n].mass) * motion[n].momentum;
    body.L = motion[n].angular;
    if (given.count(static_cast<int>(objects.id(n)))) {
      const PrincipalAxes axes = principal_axes(found[n].inertia);
      const Vec3 spin = times_moments(matrix(axes.q), inverse_of(axes.moments), body.L);
      body.L = times_moments(body.turn, body.moments, spin);
    }
    body.refresh();
  }
}

// Particles may have been moved, or been given other velocities, since the last run.
void FixMdanimRigid::follow_changes()
{
  const RigidParticles::BodyChanges changes = particles.changes(bodies);
  if (largest(changes.moved) > 0.0) {
    if (!given.empty() || touching.is_on())
      error->all(FLERR,
                 "{}: particles were moved since the last run, so the {} in its file are those of other places; write the "
                 "fix again, with a file for the new places",
                 name(), given.empty() ? "shapes" : "moments");
    make();
  } else if (largest(changes.pushed) > 0.0) {
    sleep.wake_all();
    set_velocities(particles.weigh());
    glue.glued.take_motion(bodies);
    particles.put(bodies, false);
    touching.is_current = false;
  }
}
