// SPDX-License-Identifier: GPL-2.0-only
// A rigid body under forces, by the leap-frog of the particles: Wcislo 1999, eq. (3.12), with v and L in place of v.

#pragma once

#include "leapfrog/law.h"
#include "numbers/matrix3.h"
#include "rigid/rotation.h"

namespace mdanim {

// v and L are those at whole steps, or half a step later between begin_step() and finish_step().
struct RigidBody {
  double mass = 0.0;
  Vec3 moments;    // about its principal axes, ascending
  Vec3 centre, velocity;
  Quaternion q;    // takes its principal axes into space
  Vec3 L;          // angular momentum about the centre, in space

  bool aside = false;    // has left the simulation: does not move, and has no energy

  Vec3 force, torque;
  Matrix3 turn;    // matrix(q)
  Vec3 over;       // 1 / moments
  Vec3 spin;       // angular velocity, in space

  // To be called after mass, moments, q or L were set.
  void refresh()
  {
    over = {inverse(moments.x), inverse(moments.y), inverse(moments.z)};
    turn = matrix(q);
    find_spin();
  }

  // v <- v + dt/2m F, L <- L + dt/2 T; `half` is dt/2 in units of velocity times mass/force.
  void kick(double half)
  {
    velocity += (half / mass) * force;
    L += half * torque;
    find_spin();
  }
  // The same with drag: a force -lambda v and a torque -lambda/m L. Returns the energy that it takes (see Implicit::loss).
  double kick_with_drag(double half, double lambda, bool first)
  {
    const Implicit<double> drag = Implicit<double>::of(lambda * half / mass, half / mass),
                           turning{drag.phi, half, drag.stay, drag.share};
    const Vec3 v = velocity, before = L, spin_before = spin;
    velocity = first ? drag.first_half(v, force) : drag.final_half(v, force);
    L = first ? turning.first_half(before, torque) : turning.final_half(before, torque);
    find_spin();
    const Vec3 push = half * torque, lag = first ? (2.0 / 3.0) * L - 0.5 * before : 0.5 * L - (2.0 / 3.0) * before;
    return drag.loss(v, velocity, force, mass, first) + 0.5 * dot(spin_before + spin, push - (L - before)) +
           drag.phi * dot(push, over_moments(lag));
  }
  // Position and rotation after dt, with v and L as they are.
  void drift(double dt)
  {
    centre += dt * velocity;
    rotate_freely(q, L, over, dt);
    turn = matrix(q);
    find_spin();
  }

  // Velocity of a point of the body, given by its place in space from the centre.
  Vec3 velocity_at(const Vec3 &from_centre) const { return velocity + cross(spin, from_centre); }

  // I^-1 a.
  Vec3 over_moments(const Vec3 &a) const
  {
    const Vec3 body = transposed_times(turn, a);
    return turn * Vec3{over.x * body.x, over.y * body.y, over.z * body.z};
  }

  double translation() const { return aside ? 0.0 : 0.5 * mass * dot(velocity, velocity); }
  double rotation() const { return aside ? 0.0 : 0.5 * dot(L, spin); }

 private:
  static double inverse(double moment) { return moment > 0.0 ? 1.0 / moment : 0.0; }
  void find_spin() { spin = over_moments(L); }
};

}    // namespace mdanim
