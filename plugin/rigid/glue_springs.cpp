// SPDX-License-Identifier: GPL-2.0-only

#include "rigid/glue_springs.h"

#include "rigid/coarse_glue.h"

#include <cstddef>
#include <utility>

namespace mdanim {

static constexpr double TOLERANCE = 1e-5;         // of loads that are not balanced, over all loads
static constexpr std::size_t LEAST_LOOPS = 50;    // and as many for each piece

FaceForce face_force(const GlueSpring &spring, const PieceMotions &x)
{
  const PieceMotion &a = x[spring.a], &b = x[spring.b];
  const Vec3 way = (a.place + cross(a.turn, spring.arm_a)) - (b.place + cross(b.turn, spring.arm_b)), turn = a.turn - b.turn;
  const Vec3 *const e = spring.axis;
  return {-spring.stiffness * Vec3{dot(way, e[0]), dot(way, e[1]), dot(way, e[2])},
          {-spring.twist.x * dot(turn, e[0]), -spring.twist.y * dot(turn, e[1]), -spring.twist.z * dot(turn, e[2])}};
}

void add_diagonal(const GlueSpring &spring, PieceMotions &stiff)
{
  const auto square = [](const Vec3 &v) { return Vec3{v.x * v.x, v.y * v.y, v.z * v.z}; };
  const double twist[3] = {spring.twist.x, spring.twist.y, spring.twist.z};
  for (int k = 0; k < 3; ++k)
    for (const auto &[end, arm] : {std::pair{spring.a, spring.arm_a}, {spring.b, spring.arm_b}}) {
      stiff[end].place += spring.stiffness * square(spring.axis[k]);
      stiff[end].turn += spring.stiffness * square(cross(arm, spring.axis[k])) + twist[k] * square(spring.axis[k]);
    }
}

namespace {

Vec3 along(const Vec3 *axis, const Vec3 &v) { return v.x * axis[0] + v.y * axis[1] + v.z * axis[2]; }

// to += sign K of.
void add(const std::vector<GlueSpring> &springs, const PieceMotions &of, PieceMotions &to, double sign)
{
  for (const GlueSpring &one : springs) {
    const FaceForce on_a = face_force(one, of);
    const Vec3 force = sign * along(one.axis, on_a.force), torque = sign * along(one.axis, on_a.torque);
    to[one.a].place -= force;
    to[one.a].turn -= torque + cross(one.arm_a, force);
    to[one.b].place += force;
    to[one.b].turn += torque + cross(one.arm_b, force);
  }
}

PieceMotion over(const PieceMotion &a, const PieceMotion &by)
{
  return {{a.place.x / by.place.x, a.place.y / by.place.y, a.place.z / by.place.z},
          {a.turn.x / by.turn.x, a.turn.y / by.turn.y, a.turn.z / by.turn.z}};
}

double product(const PieceMotions &a, const PieceMotions &b)
{
  double all = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) all += dot(a[k].place, b[k].place) + dot(a[k].turn, b[k].turn);
  return all;
}

// of . of/stiff.
double measure(const PieceMotions &of, const PieceMotions &stiff)
{
  double all = 0.0;
  for (std::size_t k = 0; k < of.size(); ++k) {
    const PieceMotion one = over(of[k], stiff[k]);
    all += dot(of[k].place, one.place) + dot(of[k].turn, one.turn);
  }
  return all;
}

}    // namespace

void solve(const std::vector<GlueSpring> &springs, const PieceMotions &stiff, const CoarseGlue &coarse, const PieceMotions &load,
           PieceMotions &x)
{
  const std::size_t count = x.size();
  const double enough = TOLERANCE * TOLERANCE * measure(load, stiff);
  PieceMotions left = load, down(count), pull(count);
  // Finds what pieces move by the load that is left, each for itself and in groups; returns the work.
  const auto descend = [&] {
    for (std::size_t k = 0; k < count; ++k) down[k] = over(left[k], stiff[k]);
    if (coarse.is_on()) coarse.add(left, down);
    return product(left, down);
  };
  add(springs, x, left, -1.0);
  if (!(measure(left, stiff) > enough)) return;
  double now = descend();
  PieceMotions way = down;
  for (std::size_t loop = 0; loop < LEAST_LOOPS + 6 * count; ++loop) {
    pull.assign(count, {});
    add(springs, way, pull, 1.0);
    const double slope = product(way, pull);
    if (!(slope > 0.0)) break;
    const double step = now / slope;
    for (std::size_t k = 0; k < count; ++k) {
      x[k].place += step * way[k].place, x[k].turn += step * way[k].turn;
      left[k].place -= step * pull[k].place, left[k].turn -= step * pull[k].turn;
    }
    if (!(measure(left, stiff) > enough)) break;
    const double next = descend(), part = next / now;
    for (std::size_t k = 0; k < count; ++k) way[k] = {down[k].place + part * way[k].place, down[k].turn + part * way[k].turn};
    now = next;
  }
}

std::vector<FaceLoads> hanging_loads(const std::vector<GlueSpring> &springs, const std::vector<Vec3> &places, PieceMotions load)
{
  std::vector<FaceLoads> found(places.size());
  if (springs.size() + 1 != places.size()) return found;
  std::vector<std::vector<int>> of_piece(places.size());
  for (std::size_t s = 0; s < springs.size(); ++s)
    for (const int piece : {springs[s].a, springs[s].b}) of_piece[piece].push_back(static_cast<int>(s));
  struct Hung {
    int piece, on, by;
  };
  std::vector<Hung> order{{0, -1, -1}};    // each behind the one that it hangs on
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Hung one = order[k];
    for (const int s : of_piece[one.piece])
      if (s != one.by) order.push_back({springs[s].a == one.piece ? springs[s].b : springs[s].a, one.piece, s});
  }
  for (std::size_t k = order.size() - 1; k > 0; --k) {
    const auto [piece, on, by] = order[k];
    const Vec3 &place = places[piece], middle = place + (springs[by].a == piece ? springs[by].arm_a : springs[by].arm_b);
    const PieceMotion &own = load[piece];
    found[piece] = {own.place, own.turn + cross(place - middle, own.place), middle};
    load[on].place += own.place;
    load[on].turn += own.turn + cross(place - places[on], own.place);
  }
  return found;
}

}    // namespace mdanim
