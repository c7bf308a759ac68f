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

// How far its points are from its centre at most; infinite where one does not touch by features.
double RigidSleep::size_of(std::size_t n) const
{
  double size = 0.0;
  each_of(n, [&](std::size_t k) {
    const int piece = static_cast<int>(k), solid = touching.is_on() ? touching.solid(piece) : RigidTouching::NO_SHAPE;
    const double arm = glue.glued.holds(k) ? length(glue.glued.pose(piece).place) : 0.0;
    size = std::max(size, solid == RigidTouching::NO_SHAPE ? HUGE_VAL : arm + touching.contact.solid(solid).shape.bound());
  });
  return size;
}

double RigidSleep::acceleration_of(std::size_t n) const
{
  const RigidBody &body = whole_of(n);
  return lmp->force->ftm2v * (length(body.force) / body.mass + length(body.over_moments(body.torque)) * size_of(n));
}

bool RigidSleep::is_calm(std::size_t n) const
{
  const RigidBody &body = whole_of(n);
  const double size = size_of(n);
  if (size == HUGE_VAL || body.aside || body.guided) return false;
  bool touches = false, is_moved = false;
  each_of(n, [&](std::size_t k) {
    const Solid &solid = touching.contact.solid(touching.solid(static_cast<int>(k)));
    touches = touches || solid.touching > 0;
    is_moved = is_moved || solid.is_carried || length(solid.belt) > 0.0;
  });
  return touches && !is_moved && length(body.velocity) + length(body.spin) * size <= speed && acceleration_of(n) <= acceleration;
}

// Sets the time for which it has been calm, and tells what follows from that.
void RigidSleep::set_calm(std::size_t first, double calm)
{
  each_of(first, [&](std::size_t n) {
    RigidBody &body = bodies[n];
    body.calm = calm;
    body.asleep = is_on() && calm >= time;
    body.settled = body.asleep && calm >= time + SETTLES * lmp->update->dt;
    const int solid = touching.is_on() ? touching.solid(static_cast<int>(n)) : RigidTouching::NO_SHAPE;
    if (solid != RigidTouching::NO_SHAPE) touching.contact.rest(solid, body.asleep, body.settled);
  });
  if (glue.glued.holds(first)) glue.glued.body_of_whole(static_cast<int>(first)).asleep = bodies[first].asleep;
}

void RigidSleep::tell_contact()
{
  for (std::size_t n = 0; n < bodies.size() && is_on(); ++n)
    if (is_first(n)) set_calm(n, bodies[n].calm);
}

void RigidSleep::wake_all()
{
  for (std::size_t n = 0; n < bodies.size() && is_on(); ++n)
    if (is_first(n)) set_calm(n, 0.0);
}

void RigidSleep::wake_some()
{
  for (std::size_t n = 0; n < bodies.size() && is_on(); ++n)
    if (is_first(n) && bodies[n].asleep && acceleration_of(n) > WAKES * acceleration) set_calm(n, 0.0);
}

void RigidSleep::put_some_to_sleep(double half_dt, const std::vector<double> &drag)
{
  for (std::size_t n = 0; n < bodies.size() && is_on(); ++n) {
    const RigidBody &body = bodies[n];
    if (body.settled || !is_first(n)) continue;
    const bool slept = body.asleep;
    const double calm = slept || is_calm(n) ? body.calm + lmp->update->dt : 0.0;
    if (calm >= time && !slept) {
      const bool is_glued = glue.glued.holds(n);
      stilled += whole_of(n).kinetic(half_dt, is_glued ? glue.glued.whole(static_cast<int>(n)).drag : drag[n]);
      each_of(n, [&](std::size_t k) { bodies[k].set_motion({}, {}); });
      if (is_glued) glue.glued.body_of_whole(static_cast<int>(n)).set_motion({}, {});
    }
    if (calm >= time)
      set_calm(n, calm);
    else
      each_of(n, [&](std::size_t k) { bodies[k].calm = calm; });
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
}

}    // namespace mdanim
