// SPDX-License-Identifier: GPL-2.0-only

#include "lammps/guided_bodies.h"

#include "drives/law.h"
#include "lammps/fix_mdanim_drive.h"

#include <utility>

namespace mdanim {

void GuidedBodies::find(double half_dt, const std::vector<double> &drag)
{
  const LAMMPS_NS::FixMdanimDrive *const drive = touching.guide();
  if (!drive) return;
  for (std::size_t n = 0; n < bodies.size(); ++n) {
    RigidBody &body = bodies[n];
    const bool was_guided = std::exchange(body.guided, drive->holds(id(n)));
    if (was_guided && !body.guided) touching.work += body.kinetic(half_dt, drag.empty() ? 0.0 : drag[n]);
  }
}

void GuidedBodies::move(double dt)
{
  each([&](std::size_t n) {
    const auto &ways = *touching.guide()->ways_of(id(n));
    const DrivenStep step(ways.before, ways.now);
    const Vec3 there = step.of(bodies[n].centre), velocity = (1.0 / dt) * (there - bodies[n].centre);
    bodies[n].move_to(there, step.turned);
    bodies[n].set_motion(velocity, (1.0 / dt) * step.angle);
  });
}

void GuidedBodies::set_whole_motion(double dt)
{
  each([&](std::size_t n) {
    RigidBody &body = bodies[n];
    const auto &ways = *touching.guide()->ways_of(id(n));
    const DrivenStep back(ways.now, ways.before), on(ways.now, ways.next);
    const double per_two = 0.5 / dt;
    body.set_motion(per_two * (on.of(body.centre) - back.of(body.centre)), per_two * (on.angle - back.angle));
  });
}

void GuidedBodies::touch(double dt)
{
  std::vector<RigidTouching::Push> before;
  for (std::size_t n = 0; touching.guide() && n < bodies.size(); ++n) before.push_back(touching.push(static_cast<int>(n)));
  touching.step(bodies, dt);
  each([&](std::size_t n) {
    const RigidTouching::Push now = touching.push(static_cast<int>(n));
    touching.work -=
        0.5 * dt * (dot(before[n].force + now.force, bodies[n].velocity) + dot(before[n].torque + now.torque, bodies[n].spin));
  });
}

}    // namespace mdanim
