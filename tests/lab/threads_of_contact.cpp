// SPDX-License-Identifier: GPL-2.0-only
// Contact by one thread and by several, without LAMMPS: a program that tests/sanitize.py compiles with the thread sanitizer.
// Exit code 0: forces, sums and what contacts remember are the same to the bit.

#include "contact/contact_world.h"
#include "simd/kernels.h"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

using namespace mdanim;

namespace {

constexpr int CELLS = 5, NODES = CELLS + 1, ROW = 4, OBJECTS = ROW * ROW * 2, STEPS = 60, BETWEEN_LISTS = 12;
constexpr double H = 0.01, DT = 1e-4, SKIN = 0.01, APART = (CELLS - 0.02) * H;

// Nodes and cells of a body, and its points: on each side of a cuboid, or along rays of a ball.
struct Shape {
  std::vector<std::int32_t> node, cell;
  std::vector<std::uint8_t> filled, kind;
  std::vector<double> at, centre, normal, area, depth;

  int cell_at(const double *X) const
  {
    int at[3];
    for (int d = 0; d < 3; ++d) at[d] = std::min(static_cast<int>(X[d]), CELLS - 1);
    return at[0] + CELLS * (at[1] + CELLS * at[2]);
  }
  void add_point(const double *X, const double *outward, PointKind of)
  {
    cell.push_back(cell_at(X));
    at.insert(at.end(), X, X + 3);
    centre.insert(centre.end(), X, X + 3);
    normal.insert(normal.end(), outward, outward + 3);
    area.push_back(H * H);
    kind.push_back(static_cast<std::uint8_t>(of));
  }
  ContactBody body() const
  {
    const std::int32_t count[] = {CELLS, CELLS, CELLS};
    const double edge[] = {H, H, H};
    return ContactBody({count, edge, static_cast<int>(node.size()), node.data(), filled.data(), static_cast<int>(cell.size()),
                        cell.data(), at.data(), centre.data(), normal.data(), area.data(), kind.data(),
                        depth.empty() ? nullptr : depth.data(), depth.size()});
  }
};

// Both shapes have all cells of a cube; the ball's surface is inside of it, and its points are denser.
Shape whole_cube()
{
  Shape shape;
  for (int n = 0; n < NODES * NODES * NODES; ++n) shape.node.push_back(n);
  shape.filled.assign(CELLS * CELLS * CELLS, 1);
  return shape;
}

Shape cuboid()
{
  Shape shape = whole_cube();
  for (int side = 0; side < 6; ++side)
    for (int n = 0; n < NODES * NODES; ++n) {
      const int across = side / 2;
      double X[3], outward[3] = {};
      X[across] = side % 2 ? CELLS : 0;
      X[(across + 1) % 3] = n % NODES;
      X[(across + 2) % 3] = n / NODES;
      outward[across] = side % 2 ? 1.0 : -1.0;
      const bool inside = n % NODES % CELLS && n / NODES % CELLS;
      shape.add_point(X, outward, inside ? PointKind::FLAT : PointKind::SHARP);
    }
  return shape;
}

Shape ball()
{
  Shape shape = whole_cube();
  constexpr double MIDDLE = 0.5 * CELLS, RADIUS = MIDDLE - 0.01;
  constexpr int RAYS = 400, MARGIN = 2, GRID = NODES + 2 * MARGIN;
  for (int n = 0; n < RAYS; ++n) {
    const double z = 1.0 - (2.0 * n + 1.0) / RAYS, turn = 2.4 * n, r = std::sqrt(1.0 - z * z);
    const double outward[] = {r * std::cos(turn), r * std::sin(turn), z};
    const double X[] = {MIDDLE + RADIUS * outward[0], MIDDLE + RADIUS * outward[1], MIDDLE + RADIUS * outward[2]};
    shape.add_point(X, outward, PointKind::DENSE);
  }
  for (int n = 0; n < GRID * GRID * GRID; ++n) {
    double square = 0.0;
    for (const int i : {n % GRID, n / GRID % GRID, n / GRID / GRID}) square += std::pow(i - MARGIN - MIDDLE, 2);
    shape.depth.push_back(H * (RADIUS - std::sqrt(square)));
  }
  return shape;
}

// Two layers of cubes and balls that press and rub each other and the ground, and turn.
void place_all(int step, std::vector<double> (&x)[3], std::vector<Box> &boxes)
{
  for (int o = 0; o < OBJECTS; ++o) {
    const double t = step * DT, phase = 1.3 * o;
    const double at[] = {APART * (o % ROW) + 0.3 * H * std::sin(40.0 * t + phase),
                         APART * (o / ROW % ROW) + 0.6 * H * std::sin(90.0 * t),
                         APART * (o / ROW / ROW) + 0.3 * H * std::sin(130.0 * t + 2.0 * phase)};
    boxes[o] = Box();
    for (int n = 0; n < NODES * NODES * NODES; ++n) {
      const double X[] = {H * (n % NODES), H * (n / NODES % NODES), H * (n / NODES / NODES)},
                   turn = 0.1 * std::sin(70.0 * t + phase);
      const double place[] = {at[0] + X[0] - turn * X[1], at[1] + X[1] + turn * X[0], at[2] + X[2]};
      boxes[o].include(place);
      for (int d = 0; d < 3; ++d) x[d][o * NODES * NODES * NODES + n] = place[d];
    }
  }
}

using Body = std::shared_ptr<const ContactBody>;

struct Told {
  std::vector<double> numbers;
  std::vector<char> remembered;
  double most = 0.0;
};

Told film(int threads, const ContactKernels *kernels, const Body &cube, const Body &round)
{
  ContactWorld world;
  world.settings.objects = true;
  world.settings.damping = 0.3;
  world.settings.planes = {{2, 1.0, 0.2 * H}, {0, 1.0, 0.1 * H}};
  world.use(kernels, Threads(threads));
  std::vector<ContactObject> objects;
  for (int o = 0; o < OBJECTS; ++o) {
    ContactObject one{};
    one.id = o + 1, one.body = o % 3 ? cube : round, one.young = 1e5, one.friction = 0.4, one.density = 1000.0;
    objects.push_back(one);
  }
  world.take(objects, std::vector<char>(OBJECTS, 1));
  Told told;
  std::vector<double> x[3];
  for (auto &along : x) along.resize(OBJECTS * NODES * NODES * NODES);
  std::vector<Box> boxes(OBJECTS);
  const Coordinates places = {x[0].data(), x[1].data(), x[2].data()};
  std::vector<ContactParticle> particles;
  for (int n = 0; n < static_cast<int>(x[0].size()); ++n)
    particles.push_back({n / (NODES * NODES * NODES), n % (NODES * NODES * NODES)});
  for (int step = 0; step < STEPS; ++step) {
    place_all(step, x, boxes);
    if (step % BETWEEN_LISTS == 0) {
      world.near.look_ahead(boxes, SKIN);
      world.list(particles, places);
    }
    world.step(places, step ? DT : 0.0);
    for (std::size_t n = 0; n < particles.size(); ++n)
      for (int d = 0; d < 3; ++d) told.numbers.push_back(component(world.forces()[n].value, d));
    const ContactAccount &sums = world.account;
    const Vec3 on_planes = world.force_on_planes();
    for (const double sum : {sums.energy, sums.stick_energy, sums.heat, sums.damped, sums.let_go, sums.deepest, sums.looks,
                             1.0 * sums.touching, on_planes.x, on_planes.z})
      told.numbers.push_back(sum);
    told.most = std::max(told.most, 1.0 * sums.touching);
  }
  for (const auto &[key, record] : world.records()) told.remembered.insert(told.remembered.end(), record.begin(), record.end());
  std::printf("%d threads: %zu pairs, %.0f points at most, %.3g J of heat, %.0f looks\n", threads, world.near.pairs().size(),
              told.most, world.account.heat, world.account.looks);
  return told;
}

}    // namespace

int main()
{
  const auto cube = std::make_shared<const ContactBody>(cuboid().body()),
             round = std::make_shared<const ContactBody>(ball().body());
  const Told alone = film(1, nullptr, cube, round);
  if (!(alone.most > 500.0)) return 2;
  const auto is_same = [&](int threads, const ContactKernels *kernels) {
    const Told shared = film(threads, kernels, cube, round);
    return shared.numbers.size() == alone.numbers.size() && shared.remembered == alone.remembered &&
           !std::memcmp(shared.numbers.data(), alone.numbers.data(), alone.numbers.size() * sizeof(double));
  };
  for (const int threads : {1, 2, 5})
    if (!is_same(threads, &widest_kernels().contact)) {
      std::printf("%d threads give other bits\n", threads);
      return 1;
    }
  return is_same(4, nullptr) ? 0 : 1;
}
