// SPDX-License-Identifier: GPL-2.0-only

#include "lammps/rigid_sleep.h"

#include "error.h"
#include "force.h"
#include "lammps.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace mdanim {

static constexpr double WAKES = 4.0;    // acceleration at which a body wakes, over that of the rule
static constexpr int SETTLES = 4;       // steps of sleep until contacts remember nothing of the motion before

void RigidSleep::read_word(int iarg, char **arg)
{
  double *const numbers[] = {&speed, &acceleration, &time};
  for (int k = 0; k < 3; ++k) {
    *numbers[k] = utils::numeric(FLERR, arg[iarg + 1 + k], false, lmp);
    if (!(*numbers[k] > 0.0))
      lmp->error->all(FLERR, iarg + 1 + k, "fix mdanim/rigid: speed, acceleration and time of sleep must be above 0, got {}",
                      arg[iarg + 1 + k]);
  }
  touching.contact.settings.sleeps = true;
}

std::vector<Output> RigidSleep::outputs()
{
  return {{"stilled", true, [this] { return lmp->force->mvv2e * stilled; }},
          {"asleep", true, [this] { return static_cast<double>(sleepers()); }}};
}

int RigidSleep::sleepers() const
{
  return static_cast<int>(std::count_if(bodies.begin(), bodies.end(), [](const RigidBody &one) { return one.asleep; }));
}

// How far its points are from its centre at most; 0 of a body that does not touch by features.
double RigidSleep::size_of(std::size_t n) const
{
  const int solid = touching.is_on() ? touching.solid(static_cast<int>(n)) : RigidTouching::NO_SHAPE;
  return solid == RigidTouching::NO_SHAPE ? 0.0 : touching.contact.solid(solid).shape.bound();
}

double RigidSleep::acceleration_of(std::size_t n) const
{
  const RigidBody &body = bodies[n];
  return lmp->force->ftm2v * (length(body.force) / body.mass + length(body.over_moments(body.torque)) * size_of(n));
}

bool RigidSleep::is_calm(std::size_t n) const
{
  const RigidBody &body = bodies[n];
  const double size = size_of(n);
  if (size == 0.0 || body.aside || body.guided || glue.glued.holds(n)) return false;
  const Solid &solid = touching.contact.solid(touching.solid(static_cast<int>(n)));
  return solid.touching > 0 && !solid.is_carried && length(solid.belt) == 0.0 &&
         length(body.velocity) + length(body.spin) * size <= speed && acceleration_of(n) <= acceleration;
}

// Tells what follows from the time for which a body has been calm.
void RigidSleep::tell(std::size_t n)
{
  RigidBody &body = bodies[n];
  body.asleep = is_on() && body.calm >= time;
  body.settled = body.asleep && body.calm >= time + SETTLES * lmp->update->dt;
  const int solid = touching.is_on() ? touching.solid(static_cast<int>(n)) : RigidTouching::NO_SHAPE;
  if (solid != RigidTouching::NO_SHAPE) touching.contact.rest(solid, body.asleep, body.settled);
}

void RigidSleep::tell_contact()
{
  for (std::size_t n = 0; n < bodies.size() && is_on(); ++n) tell(n);
}

void RigidSleep::wake_all()
{
  for (std::size_t n = 0; n < bodies.size() && is_on(); ++n) {
    bodies[n].calm = 0.0;
    tell(n);
  }
}

void RigidSleep::wake_some()
{
  for (std::size_t n = 0; n < bodies.size() && is_on(); ++n)
    if (bodies[n].asleep && acceleration_of(n) > WAKES * acceleration) {
      bodies[n].calm = 0.0;
      tell(n);
    }
}

void RigidSleep::put_some_to_sleep(double half_dt, const std::vector<double> &drag)
{
  for (std::size_t n = 0; n < bodies.size() && is_on(); ++n) {
    RigidBody &body = bodies[n];
    if (body.settled) continue;
    const bool slept = body.asleep;
    body.calm = slept || is_calm(n) ? body.calm + lmp->update->dt : 0.0;
    if (body.calm < time) continue;
    if (!slept) {
      stilled += body.kinetic(half_dt, drag[n]);
      body.set_motion({}, {});
    }
    tell(n);
  }
}

void RigidSleep::put(std::size_t n, ByteWriter &writer) const
{
  if (is_on()) writer.put(bodies[n].calm);
}

void RigidSleep::read(std::vector<std::optional<ByteReader>> &records)
{
  for (std::size_t n = 0; n < bodies.size() && is_on(); ++n) {
    if (!records[n]) continue;
    bodies[n].calm = records[n]->get<double>();
    const double values[] = {bodies[n].calm};
    records[n]->expect_numbers(values, "how long it has lain still", 0.0);
  }
  tell_contact();
}

}    // namespace mdanim
