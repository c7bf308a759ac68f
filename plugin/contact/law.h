// SPDX-License-Identifier: GPL-2.0-only
// The forces on a point of a drawn surface that lies below the surface of another body (docs/physics-contact.md).
//   U = kappa w t g(d - d0)    d = depth of the point, w = its area, t = part of it that counts (0 to 1)
//   g(d) = d^3 / (6 eps) for 0 < d < eps, else (d - eps/2)^2 / 2 + eps^2 / 24: twice continuously differentiable
// Friction is a spring between the point and a material point of the other body, its anchor: it holds up to mu |F|, then the
// anchor is dragged along.
// Templates over Real (real.h): several contacts at once have the bits of each alone.

#pragma once

#include "numbers/vec3.h"

namespace mdanim {

// The law of one pair of bodies.
struct ContactLaw {
  double kappa = 0.0;                     // stiffness of the surface [N/m^3]
  double onset = 0.0;                     // eps [m]
  double friction = 0.0;                  // mu
  double damping = 0.0;                   // dashpot of the depth over kappa [s], 2 beta sqrt(kappa rho h / 2) / kappa
  Vec3 belt{};                            // velocity at which the other body's surface runs over it, less that of the own [m/s]
  static constexpr double STICK = 0.8;    // kappa_t / kappa
  bool runs() const { return belt.x != 0.0 || belt.y != 0.0 || belt.z != 0.0; }
};

// g(d) and its derivative.
template <class Real> struct Onset {
  Real value, slope;
  MDANIM_ALWAYS_INLINE Onset(const Real &d, double eps)
  {
    const Real past = d - 0.5 * eps;
    const Real square = d * d;
    value = pick(d < eps, (1.0 / (6.0 * eps)) * (square * d), 0.5 * past * past + eps * eps / 24.0);
    slope = pick(d < eps, (0.5 / eps) * square, past);
    value = pick(d <= 0.0, Real{}, value);
    slope = pick(d <= 0.0, Real{}, slope);
  }
};

// Values of a point in contact that are kept from the step before.
template <class Real> struct ContactMemory {
  Real offset{};          // d0 [m]
  Real depth{};           // d [m]
  Vec<Real> pull;         // force of the stick spring [N]
  Real stick{};           // its stiffness kappa_t w t [N/m]
  Real stick_energy{};    // [J]
  Real damping{};         // force of the dashpot of the depth [N]
  Vec<Real> drag;         // that of the dashpot of the stick spring [N]
};

template <class Real> struct ContactForce {
  Real press{};             // -dU/dd and the dashpot [N]: the force is -press times the gradient of d in space
  Real surface_energy{};    // kappa w g [N m], what the gradient of t is multiplied by; U = t times this
  Vec<Real> pull;           // force of the stick spring: it acts at the anchor
  Vec<Real> drag;           // force of its dashpot
  Real kept{};              // part of the way to the anchor that remains after the slip
  Real heat{}, damped{};    // energy that friction and dashpots took in this step [J]
};

// The part of a contact that depends on the depth alone. `dt` = 0: no dashpot, as at the setup of a run.
template <class Real>
MDANIM_ALWAYS_INLINE ContactForce<Real> contact_pressure(const ContactLaw &law, const Real &area, const Real &part,
                                                         const Real &depth, double dt, ContactMemory<Real> &memory)
{
  memory.offset = smaller(memory.offset, depth);
  const Onset<Real> g(depth - memory.offset, law.onset);
  const Real k = law.kappa * area;
  ContactForce<Real> force;
  force.surface_energy = k * g.value;
  force.press = k * part * g.slope;
  if (law.damping > 0.0 && dt > 0.0) {
    const Real deeper = depth - memory.depth;
    const Real pushed = larger(law.damping * k * part * deeper / dt, -force.press);    // a dashpot never pulls
    const Real more = pick(depth > memory.offset, pushed, Real{});
    force.damped = 0.5 * (memory.damping + more) * deeper;    // the mean of the forces before and after does the work
    force.press += more;
    memory.damping = more;
  }
  memory.depth = depth;
  return force;
}

// Work of the dashpot of the depth in the step in which the contact ends.
MDANIM_ALWAYS_INLINE double last_damping_work(const ContactMemory<double> &memory, double depth)
{ return 0.5 * memory.damping * (depth - memory.depth); }

// Friction. `away` is the vector from the anchor to the point in space [m], `normal` the gradient of d there.
template <class Real>
MDANIM_ALWAYS_INLINE void contact_friction(const ContactLaw &law, const Real &area, const Real &part, const Vec<Real> &away,
                                           const Vec<Real> &normal, double dt, ContactMemory<Real> &memory,
                                           ContactForce<Real> &force)
{
  const Real k = ContactLaw::STICK * law.kappa * area * part;
  const Real square = dot(normal, normal), length = root(dot(away, away));
  const Real most = law.friction * force.press * root(square), pull = k * length;
  const auto slips = pull > most;
  force.kept = pick(slips, most / pull, constant<Real>(1.0));
  const Real compliance = pick(memory.stick > 0.0, -1.0 / memory.stick, Real{});
  const Vec<Real> before = compliance * memory.pull;
  if (dt > 0.0 && law.damping > 0.0) {
    Vec<Real> way = away - before;
    way -= pick(square > 0.0, dot(way, normal) / square, Real{}) * normal;
    const Real eta = law.damping * k / __builtin_sqrt(ContactLaw::STICK);    // 2 beta sqrt(kappa_t rho h / 2) w t
    const Vec<Real> drag = (-eta / dt) * way;
    force.drag = {pick(slips, Real{}, drag.x), pick(slips, Real{}, drag.y), pick(slips, Real{}, drag.z)};
    force.damped -= 0.5 * dot(memory.drag + force.drag, way);
    memory.drag = force.drag;
  }
  const Vec<Real> left = force.kept * away;
  force.pull = -k * left;
  if (dt > 0.0) {
    force.heat = pick(slips, -0.5 * dot(force.pull + memory.pull, away - left), Real{});
    // Where less of the point counts than before, the spring is softer, and no work is done.
    force.heat += 0.5 * (memory.stick - k) * dot(left, before);
  }
  memory.pull = force.pull;
  memory.stick = k;
  memory.stick_energy = 0.5 * k * dot(left, left);
}

// Part of a depth that counts where the host is pressed flat, so that the depth that counts, f = phi d, continues to be a
// distance in space: the gradient of d is 1 in an undeformed cell, and unbounded in a flattened one.
//   phi(n) = y(n)/n,  y = n below STEEP, STEEP + a (n - STEEP)/(n - STEEP + a) beyond    n = |gradient of d in space|, a = MORE
template <class Real> struct Flattened {
  static constexpr double STEEP = 1.1, MORE = 1.0;
  Real value, slope;    // phi, and -d(log phi)/dn over n
  MDANIM_ALWAYS_INLINE explicit Flattened(const Real &steepness)
  {
    const Real over = larger(steepness - STEEP, Real{}), room = over + MORE, y = STEEP + MORE * over / room;
    const auto is_flat = steepness > STEEP;
    value = pick(is_flat, y / steepness, constant<Real>(1.0));
    slope = pick(is_flat, (1.0 / steepness - MORE * MORE / (room * room * y)) / steepness, Real{});
  }
};

// Energy lost with a contact that is let go in a step: the energy that it held, less the work of its last force in half of the
// step, as leap-frog counts. `energy` is the energy that it held, `deeper` the change of depth since then, `part` the part that
// counts now.
inline double let_go_energy(const ContactLaw &law, double area, const ContactMemory<double> &memory, double energy, double deeper,
                            double part)
{
  const Onset<double> g(memory.depth - memory.offset, law.onset);
  if (!(g.value > 0.0)) return energy;
  const double k = law.kappa * area, was = energy / (k * g.value);    // part that counted
  return energy + 0.5 * k * (was * g.slope * deeper + (part - was) * g.value);
}

// Part of a point that counts near a sharp edge of the other body, `inside` cells from it: 0 before `from`, 1 a `width` later.
// The slope rises and falls evenly over ROUND of the width each, because a kink would be a sudden force. Ramps of points that are
// (1 - ROUND) width apart add up to a straight line.
template <class Real> struct Ramp {
  static constexpr double ROUND = 0.05;
  Real value, slope;
  MDANIM_ALWAYS_INLINE Ramp(const Real &inside, double from, double width)
  {
    constexpr double OVER_SUM = 1.0 / (1.0 - ROUND), OVER_ROUND = OVER_SUM / ROUND;
    const double over = 1.0 / width;
    const Real r = smaller(larger(over * (inside - from), Real{}), constant<Real>(1.0));
    const Real first = smaller(r, constant<Real>(ROUND)), last = larger(r - (1.0 - ROUND), Real{});
    value = OVER_SUM * (r - first) + (0.5 * OVER_ROUND) * (first * first - last * last);
    value = pick(r < 1.0, value, constant<Real>(1.0));    // exactly 1, as without a ramp
    slope = (OVER_ROUND * over) * (first - last);
  }
};

}    // namespace mdanim
