// SPDX-License-Identifier: GPL-2.0-only
// Contact of rigid bodies by one thread and by several, without LAMMPS: a program that tests/sanitize.py compiles with the thread
// sanitizer. Exit code 0: motion, sums and what contacts remember are the same to the bit.

#include "rigid/rigid_contact.h"

#include <cstdio>
#include <cstring>
#include <vector>

using namespace mdanim;

namespace {

constexpr int SIDE = 4, LAYERS = 3, BODIES = SIDE * SIDE * LAYERS, STEPS = 400, ASLEEP = 5;
constexpr double HALF = 0.05, MASS = 0.6, DT = 1e-3, FREQUENCY = 350.0;

// Boxes, balls and cylinders in layers, close to each other; the first ones sleep, and give what they give to others by pairs.
std::vector<Solid> solids(std::vector<RigidBody> &bodies)
{
  const SolidShape shapes[] = {SolidShape::of(Polyhedron::box({HALF, HALF, HALF})), SolidShape::ball(HALF),
                               SolidShape::cylinder(HALF, 2.0 * HALF)};
  std::vector<Solid> all(BODIES);
  for (int n = 0; n < BODIES; ++n) {
    RigidBody body;
    const double moment = MASS * HALF * HALF * (2.0 / 3.0);
    body.mass = MASS;
    body.moments = {moment, moment, moment};
    body.centre = {2.01 * HALF * (n % SIDE), 2.01 * HALF * (n / SIDE % SIDE), HALF * (1.0 + 2.02 * (n / SIDE / SIDE))};
    body.velocity = {0.3 * (n % 3 - 1), 0.2 * (n % 2), -0.5};
    body.refresh();
    bodies.push_back(body);
    Solid &one = all[n];
    one.id = n + 1;
    one.shape = shapes[n % 3];
    one.over_mass = 1.0 / MASS;
    one.over = body.over;
    one.material = {0.4, 0.2, false, n % 2 ? 1e-3 : 0.0};
    one.asleep = n < ASLEEP;
  }
  return all;
}

struct Told {
  std::vector<double> numbers;
  Bytes remembered;
  int most = 0;
};

Told film(int threads)
{
  RigidContact contact;
  contact.use(Threads(threads));
  contact.settings.objects = true;
  contact.settings.frequency = FREQUENCY;
  contact.settings.onset = 0.005 * HALF;
  contact.settings.planes = {{{0.0, 0.0, 1.0}, 0.0}, {{1.0, 0.0, 0.0}, -1.01 * HALF}};
  std::vector<RigidBody> bodies;
  contact.take(solids(bodies));
  Told told;
  for (int step = 0; step < STEPS; ++step) {
    for (int n = 0; n < BODIES; ++n) {
      if (n >= ASLEEP && step > 0) bodies[n].drift(DT);
      contact.place(n, bodies[n]);
    }
    contact.step(step > 0 ? DT : 0.0);
    for (int n = ASLEEP; n < BODIES; ++n) {
      bodies[n].force = contact.solid(n).force + Vec3{0.0, 0.0, -9.81 * MASS};
      bodies[n].torque = contact.solid(n).torque;
      bodies[n].kick(DT);
    }
    for (int n = 0; n < BODIES; ++n)
      for (const Vec3 &one : {bodies[n].centre, contact.solid(n).force, contact.solid(n).torque})
        told.numbers.insert(told.numbers.end(), {one.x, one.y, one.z});
    const TouchAccount &sums = contact.found();
    told.numbers.insert(told.numbers.end(), {sums.energy, sums.heat, sums.damped, sums.let_go, sums.deepest, sums.worst_bound,
                                             1.0 * sums.touching, 1.0 * sums.most_touching});
    told.most = std::max(told.most, sums.touching);
  }
  const auto remember = [&](const Bytes &bytes) { told.remembered.insert(told.remembered.end(), bytes.begin(), bytes.end()); };
  contact.each_pair_record([&](int, int, const Bytes &bytes) { remember(bytes); });
  for (int n = 0; n < BODIES; ++n) {
    ByteWriter writer;
    contact.put_at_planes(n, writer);
    remember(writer.take());
  }
  std::printf("%d threads: %zu near pairs, %d contacts at most, %.3g J of heat\n", threads, contact.near_pairs(), told.most,
              contact.account.heat);
  return told;
}

}    // namespace

int main()
{
  const Told alone = film(1);
  if (!(alone.most > 100)) return 2;
  for (const int threads : {2, 5}) {
    const Told shared = film(threads);
    if (shared.numbers.size() != alone.numbers.size() || shared.remembered != alone.remembered ||
        std::memcmp(shared.numbers.data(), alone.numbers.data(), alone.numbers.size() * sizeof(double))) {
      std::printf("%d threads give other bits\n", threads);
      return 1;
    }
  }
  return 0;
}
