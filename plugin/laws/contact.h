// SPDX-License-Identifier: GPL-2.0-only
// What acts on a point of a drawn surface that lies below the surface of another body (docs/physics-contact.md).
//   U = kappa w t g(d - d0)    d = depth of the point, w = its area, t = part of it that counts (0 to 1)
//   g(d) = d^3 / (6 eps) for 0 < d < eps, else (d - eps/2)^2 / 2 + eps^2 / 24: twice continuously differentiable
// Friction is a spring between the point and a material point of the other body, its anchor: it holds up to mu |F|, then the
// anchor is dragged along.

#ifndef MDANIM_CONTACT_H
#define MDANIM_CONTACT_H

#include "laws/vec3.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

// Of one pair of bodies.
struct ContactLaw {
  double kappa = 0.0;                     // stiffness of the surface [N/m^3]
  double onset = 0.0;                     // eps [m]
  double friction = 0.0;                  // mu
  double damping = 0.0;                   // dashpot of the depth over kappa [s], 2 beta sqrt(kappa rho h / 2) / kappa
  static constexpr double STICK = 0.8;    // kappa_t / kappa
};

// g(d) and its derivative.
struct Onset {
  double value = 0.0, slope = 0.0;
  Onset(double d, double eps)
  {
    if (d <= 0.0) return;
    const double past = d - 0.5 * eps;
    value = d < eps ? d * d * d / (6.0 * eps) : 0.5 * past * past + eps * eps / 24.0;
    slope = d < eps ? d * d / (2.0 * eps) : past;
  }
};

// What a point in contact remembers of the step before.
struct ContactMemory {
  double offset = 0.0;          // d0 [m]
  double depth = 0.0;           // d [m]
  Vec3 pull;                    // force of the stick spring [N]
  double stick = 0.0;           // its stiffness kappa_t w t [N/m]
  double stick_energy = 0.0;    // [J]
  double damping = 0.0;         // force of the dashpot of the depth [N]
  Vec3 drag;                    // that of the dashpot of the stick spring [N]
};

struct ContactForce {
  double press = 0.0;                 // -dU/dd and the dashpot [N]: the force is -press times the gradient of d in space
  double surface_energy = 0.0;        // kappa w g [N m], what the gradient of t is multiplied by; U = t times this
  Vec3 pull;                          // of the stick spring: it acts at the anchor
  Vec3 drag;                          // of its dashpot
  double kept = 1.0;                  // part of the way to the anchor that is left after the slip
  double heat = 0.0, damped = 0.0;    // energy that friction and dashpots took in this step [J]
};

// The part of a contact that depends on the depth alone. `dt` = 0: no dashpot, as at the setup of a run.
inline ContactForce contact_pressure(const ContactLaw &law, double area, double part, double depth, double dt,
                                     ContactMemory &memory)
{
  memory.offset = std::min(memory.offset, depth);
  const Onset g(depth - memory.offset, law.onset);
  const double k = law.kappa * area;
  ContactForce force;
  force.surface_energy = k * g.value;
  force.press = k * part * g.slope;
  if (law.damping > 0.0 && dt > 0.0) {
    const double deeper = depth - memory.depth;
    double more = 0.0;
    if (depth > memory.offset) more = std::max(law.damping * k * part * deeper / dt, -force.press);    // a dashpot never pulls
    force.damped = 0.5 * (memory.damping + more) * deeper;    // the mean of the forces before and after does the work
    force.press += more;
    memory.damping = more;
  }
  memory.depth = depth;
  return force;
}

// What the dashpot of the depth still takes in the step in which the contact ends.
inline double last_damping_work(const ContactMemory &memory, double depth)
{ return 0.5 * memory.damping * (depth - memory.depth); }

// Friction. `away` is the way from the anchor to the point in space [m], `normal` the gradient of d there.
inline void contact_friction(const ContactLaw &law, double area, double part, const Vec3 &away, const Vec3 &normal, double dt,
                             ContactMemory &memory, ContactForce &force)
{
  const double k = ContactLaw::STICK * law.kappa * area * part;
  const double square = dot(normal, normal), length = std::sqrt(dot(away, away));
  const double most = law.friction * force.press * std::sqrt(square), pull = k * length;
  const bool slips = pull > most;
  force.kept = slips ? most / pull : 1.0;
  if (dt > 0.0 && law.damping > 0.0) {
    const Vec3 before = memory.stick > 0.0 ? (-1.0 / memory.stick) * memory.pull : Vec3{};
    Vec3 way = away - before;
    if (square > 0.0) way -= (dot(way, normal) / square) * normal;
    const double eta = law.damping * k / std::sqrt(ContactLaw::STICK);    // 2 beta sqrt(kappa_t rho h / 2) w t
    if (!slips) force.drag = (-eta / dt) * way;
    force.damped -= 0.5 * dot(memory.drag + force.drag, way);
    memory.drag = force.drag;
  }
  const Vec3 left = force.kept * away;
  force.pull = -k * left;
  if (slips && dt > 0.0) force.heat = -0.5 * dot(force.pull + memory.pull, away - left);
  memory.pull = force.pull;
  memory.stick = k;
  memory.stick_energy = 0.5 * k * dot(left, left);
}

// Part of a point that counts near a sharp edge of the other body, `inside` cells from it: 0 before `from`, 1 a `width` later.
struct Ramp {
  double value, slope;
  // `bends`: without kinks, for points so many that they need not add up to a straight line.
  Ramp(double inside, double from, double width, bool bends)
  {
    const double r = std::clamp((inside - from) / width, 0.0, 1.0);
    value = bends ? r * r * (3.0 - 2.0 * r) : r;
    slope = bends ? 6.0 * r * (1.0 - r) / width : r > 0.0 && r < 1.0 ? 1.0 / width : 0.0;
  }
};

}    // namespace mdanim

#endif
