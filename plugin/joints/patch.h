// SPDX-License-Identifier: GPL-2.0-only
// A patch: the particles of a body that a joint holds on to, as one body that moves and deforms alike everywhere.

#pragma once

#include "numbers/matrix3.h"

#include <cstddef>
#include <vector>

namespace mdanim {

// Motion of a patch: a material point that was at d from its centre at the start is at c + F d, with the velocity v + G d.
struct PatchMotion {
  Vec3 c, v;
  Matrix3 F = diagonal(1.0), G;

  Vec3 point(const Vec3 &d) const { return c + F * d; }
  Vec3 velocity(const Vec3 &d) const { return v + G * d; }
};

// Forces on a patch: those that do the work force·dc + moment:dF.
struct PatchLoad {
  Vec3 force;
  Matrix3 moment;

  // A force on the material point d.
  void push(const Vec3 &f, const Vec3 &d)
  {
    force += f;
    moment += outer(f, d);
  }
  PatchLoad &operator+=(const PatchLoad &other)
  {
    force += other.force;
    moment += other.moment;
    return *this;
  }
  // For a small motion.
  double work(const Vec3 &dc, const Matrix3 &dF) const
  {
    double all = dot(force, dc);
    for (int k = 0; k < 3; ++k) all += dot(moment.row[k], dF.row[k]);
    return all;
  }
};

// Weights are those that reproduce all maps c + F d by least squares with masses as weights, for places r from the centre:
//   M = sum m,   S = sum m r r^T,   c = sum m x/M,   F = (sum m x r^T) S^-1,
// so that a load acts on a particle with f = m (force/M + moment S^-1 r), which changes the motion of the patch at the least
// kinetic energy. Momentum and angular momentum are those of force and moment, whatever the deformation. Where particles stand in
// a plane, on a line or in a point, S^-1 is zero across it, and points and directions outside have no place in the patch.
class Patch {
 public:
  static constexpr double ROUNDING = 1e-12;    // of places, in which patches have no extent
  struct Member {
    double mass;
    Vec3 r;    // from the centre, at the start
  };

  // The world: does not move.
  Patch() = default;
  // The centre of particles becomes that of the patch.
  static Patch of(std::vector<Member> at_places);
  // From members whose places are from the centre already.
  static Patch from(std::vector<Member> members, const Vec3 &centre);

  bool is_world() const { return all.empty(); }
  const std::vector<Member> &members() const { return all; }
  const Vec3 &centre() const { return middle; }    // at the start
  double mass() const { return total; }
  int dimensions() const { return rank; }    // of its span
  const Matrix3 &second_moment() const { return S; }
  // Part of a vector that the span of the patch has.
  Vec3 within(const Vec3 &d) const { return is_world() ? d : span * d; }
  // Its directions, as many as it has dimensions.
  const Vec3 &within_span(int k) const { return axes[k]; }
  // Root of the mean square of the distances from the centre.
  double radius() const;

  // Velocity of a material point for an impulse of 1 on it; of a direction.
  double mobility(const Vec3 &d) const { return is_world() ? 0.0 : 1.0 / total + dot(d, inverse_S * d); }
  double mobility_of_direction(const Vec3 &e) const { return is_world() ? 0.0 : dot(e, inverse_S * e); }
  Vec3 velocity_of_direction(const Vec3 &e) const { return inverse_S * e; }

  // place(n) and speed(n) of the n-th member.
  template <class Place, class Speed> PatchMotion motion(const Place &place, const Speed &speed) const
  {
    if (is_world()) return {};
    PatchMotion found;
    Matrix3 places, speeds;
    found.F = {};
    for (std::size_t n = 0; n < all.size(); ++n) {
      const Vec3 mx = all[n].mass * place(n), mv = all[n].mass * speed(n);
      found.c += mx, found.v += mv;
      places += outer(mx, all[n].r), speeds += outer(mv, all[n].r);
    }
    found.c = (1.0 / total) * found.c, found.v = (1.0 / total) * found.v;
    found.F = places * inverse_S, found.G = speeds * inverse_S;
    return found;
  }

  // Calls add(n, force) for each member.
  template <class Add> void give(const PatchLoad &load, const Add &add) const
  {
    const Vec3 all_alike = (1.0 / total) * load.force;
    const Matrix3 by_place = load.moment * inverse_S;
    for (std::size_t n = 0; n < all.size(); ++n) add(n, all[n].mass * (all_alike + by_place * all[n].r));
  }

 private:
  std::vector<Member> all;
  Vec3 middle;
  double total = 0.0;
  Matrix3 S, inverse_S, span;
  Vec3 axes[3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
  int rank = 3;
};

// Rotation of a patch: its angular velocity is its angular momentum about the centre over its moments of inertia; a couple gives
// its particles the velocities of a rotation.
class PatchSpin {
 public:
  PatchSpin() = default;    // of the world
  PatchSpin(const Patch &patch, const PatchMotion &motion)
  {
    if (patch.is_world()) return;
    FS = motion.F * patch.second_moment();
    const Matrix3 now = FS * transposed(motion.F), turning = motion.G * transposed(FS);
    inverse_I = inverse(diagonal(now.row[0].x + now.row[1].y + now.row[2].z) + -1.0 * now);
    omega = inverse_I *
            Vec3{turning.row[2].y - turning.row[1].z, turning.row[0].z - turning.row[2].x, turning.row[1].x - turning.row[0].y};
  }

  Vec3 omega;
  void couple(const Vec3 &torque, PatchLoad &load) const
  {
    const Vec3 a = inverse_I * torque;
    load.moment += Matrix3{{{0.0, -a.z, a.y}, {a.z, 0.0, -a.x}, {-a.y, a.x, 0.0}}} * FS;
  }

 private:
  Matrix3 FS, inverse_I;
};

}    // namespace mdanim
