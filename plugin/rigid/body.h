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

  bool aside = false;      // has left the simulation: does not move, and has no energy
  bool guided = false;     // goes its way whatever pushes at it, and has no energy
  double calm = 0.0;       // time for which it has hardly moved (lammps/rigid_sleep.h)
  bool asleep = false;     // stays where it is whatever pushes at it, and has no energy of motion
  bool settled = false;    // asleep, and so for some steps already

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
  // The same with drag: a force -lambda v and a torque -lambda/m L. Returns the energy that it takes: lambda dt/2 times the
  // product of the velocities before and after, which is what kinetic() loses by it.
  double kick_with_drag(double half, double lambda, bool first)
  {
    const Implicit<double> drag = Implicit<double>::of(lambda * half / mass, half / mass),
                           turning{drag.phi, half, drag.stay, drag.share};
    const Vec3 v = velocity, before = L;
    velocity = first ? drag.first_half(v, force) : drag.final_half(v, force);
    L = first ? turning.first_half(before, torque) : turning.final_half(before, torque);
    find_spin();
    return drag.phi * (mass * dot(v, velocity) + dot(before, spin));
  }
  // Position and rotation after dt, with v and L as they are.
  void drift(double dt)
  {
    centre += dt * velocity;
    rotate_freely(q, L, over, dt);
    turn = matrix(q);
    find_spin();
  }

  // Goes somewhere else, turned by this rotation.
  void move_to(const Vec3 &there, const Quaternion &turned)
  {
    centre = there;
    q = unit(turned * q);
    turn = matrix(q);
  }
  // Has this velocity and angular velocity from now on.
  void set_motion(const Vec3 &v, const Vec3 &angular)
  {
    velocity = v;
    const Vec3 own = transposed_times(turn, angular);
    L = turn * Vec3{moments.x * own.x, moments.y * own.y, moments.z * own.z};
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

  double translation() const { return aside || guided ? 0.0 : 0.5 * mass * dot(velocity, velocity); }
  double rotation() const { return aside || guided ? 0.0 : 0.5 * dot(L, spin); }
  // Both together, by the velocities v- and v+ of half a step before and after: m v-.v+/2 + L-.I^-1 L+/2. Of this leap-frog gives
  // springs exactly what they gain, F dx with the mean of the forces at both ends of a way. Velocities of whole steps hold half
  // of a kick, and in a blow that takes a few steps up to (dt Omega)^2/4 of its energy too much.
  double kinetic(double half, double lambda) const
  {
    const double phi = lambda * half / mass;
    const Vec3 to_v = (half / mass) * force - phi * velocity, to_L = half * torque - phi * L;
    return aside || guided || asleep
               ? 0.0
               : translation() + rotation() - 0.5 * (mass * dot(to_v, to_v) + dot(to_L, over_moments(to_L)));
  }

 private:
  static double inverse(double moment) { return moment > 0.0 ? 1.0 / moment : 0.0; }
  void find_spin() { spin = over_moments(L); }
};

}    // namespace mdanim
