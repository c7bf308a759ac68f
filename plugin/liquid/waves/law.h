// SPDX-License-Identifier: GPL-2.0-only
// The equations of waves, for one span or link of columns of liquid, or for one in each lane (real.h). The cell, g and the
// density of the liquid are 1. The numbers (W1) … are those of docs/physics-liquid.md.

#pragma once

#include "numbers/cube_root.h"
#include "numbers/real.h"

namespace mdanim {

// Constants and settings of an update.
struct WaveLaw {
  double dt = 0.1;
  double share = 1.0;                 // of the update, this sub-update
  double film = 1.0 / 1024.0;         // a content up to this does not flow
  double viscosity = 0.02;            // between neighbouring links
  double calm = 0.0;                  // rate at which all velocities decay, see calm_rate()
  double bed = 0.0;                   // friction of the ground, times |u|/H^(4/3), see bed_friction()
  double inertia = 8.0 / 21.0;        // of rising columns, in their depth
  double quick = 0.125;               // part of the dispersive head that does not push
  double breaking = 0.3;              // difference of heads from which a front loses its inertia, completely at twice that
  double overfull = 0.15;             // part of the excess in a full span that is turned into motion
  double mean_over = 16.0;            // updates over which the head of a full span at rest is averaged
  double slam = 100.0;                // greatest fall of a head below its surface, and rise above the basin
  double height = 1.0;                // of the basin
  double fastest = 16.0;              // velocity
  double tilt[2] = {0.0, 0.0};        // acceleration of the basin, as a rise of heads from a column to the next along x and y
  double units_per_cell = 1 << 20;    // of content
};

// Friction under which waves decay to 1/e in a time: half of their energy is in velocities.
constexpr double calm_rate(double time) { return 2.0 / time; }

// Friction of the ground: n^2 g cell^(-1/3) with Manning's n [time/length^(1/3)], for cells that are so long and so high.
inline double bed_friction(double n, double g, double length, double height)
{
  const double root = inverse_cube_root(height);
  return n * n * g * length * ((root * root) * (root * root));
}

// (W1) Head of the surface of a span with solids only at its ends. A full span has the head of its rest.
template <class Real> struct SpanSurface {
  Real full, rest, phi, head;
};

template <class Real>
MDANIM_ALWAYS_INLINE SpanSurface<Real> surface(const Real &volume, const Real &capacity, const Real &roof, const Real &free_head,
                                               const Real &full, const Real &rest, const Real &phi)
{
  const Real none = constant<Real>(0.0), one = constant<Real>(1.0);
  const Real stays = pick(volume >= capacity - one, one, none), turns = pick(volume >= capacity, one, none);
  SpanSurface<Real> s;
  s.full = pick(full > none, stays, turns);
  const auto new_full = s.full > full;
  s.phi = pick(new_full, larger(phi, roof), phi);
  s.rest = pick(new_full, s.phi, rest);
  s.head = pick(s.full > none, s.rest, free_head);
  return s;
}

// (W2) Height to which a link is filled from one side: at least its lower edge.
template <class Real>
MDANIM_ALWAYS_INLINE Real level_at(const WaveLaw &law, const Real &head, const Real &volume, const Real &edge)
{ return pick(volume > constant<Real>(law.film), larger(edge, head), edge); }

template <class Real> struct Opened {
  Real height, wet, u, q;    // wetted height; 1 where liquid is on either side, else 0; velocity and flux, 0 where it is not wet
};

// (W2) The wetted opening is that of the upwind side. opening(level) is the height of a link that is open up to a level.
template <class Real, class Opening>
MDANIM_ALWAYS_INLINE Opened<Real> open_link(const Real &level_a, const Real &level_b, const Real &edge, const Real &u,
                                            const Real &q, const Opening &opening)
{
  const Real none = constant<Real>(0.0), one = constant<Real>(1.0), top = larger(level_a, level_b);
  const auto wet = top > edge;
  const Real upwind = pick(u > none, level_a, pick(u < none, level_b, top));
  return {pick(wet, opening(upwind), none), pick(wet, one, none), pick(wet, u, none), pick(wet, q, none)};
}

// The links around one: those behind and ahead along its direction, and those to the left and right of it.
template <class Real> struct Around {
  Real u[4], height[4];    // velocity, and wetted height: 0 where there is none
  Real inflow[4];          // flux from there, positive where it comes towards the link
};

// (W4) Rate at which the ground slows what flows at u, and at the flux `across` beside it: n^2 g |u|/H^(4/3), Manning's law.
template <class Real>
MDANIM_ALWAYS_INLINE Real bed_rate(const WaveLaw &law, const Real &u, const Real &across, const Real &height)
{
  const Real inverse_root = inverse_cube_root(larger(height, constant<Real>(law.film)));
  const Real square = inverse_root * inverse_root, v = across * (square * inverse_root);
  return constant<Real>(law.bed) * root(u * u + v * v) * (square * square);
}

template <class Real> struct Advected {
  Real u, rubbed;    // velocity, and what the ground has taken of it
};

// (W3) Advection of Stelling & Duinmeijer 2003 and viscosity, both as a mean of velocities; (W4) friction. Viscosity acts over
// the height that two links share: one gains the momentum that the other loses.
template <class Real>
MDANIM_ALWAYS_INLINE Advected<Real> advected(const WaveLaw &law, const Real &u, const Around<Real> &around, const Real &volume_a,
                                             const Real &volume_b, const Real &height)
{
  const Real none = constant<Real>(0.0), one = constant<Real>(1.0);
  const Real depth = larger(constant<Real>(0.5) * (volume_a + volume_b), constant<Real>(1e-6));
  const Real k = constant<Real>(law.dt) / depth;
  const Real viscous = constant<Real>(law.viscosity * law.dt) / larger(height, constant<Real>(1e-6));
  Real weight[4];
  for (int n = 0; n < 4; ++n) {
    const Real &beside = around.height[n];
    weight[n] = pick(beside > none, k * larger(around.inflow[n], none) + viscous * smaller(beside, height), none);
  }
  const Real sum = ((weight[0] + weight[1]) + weight[2]) + weight[3];
  Real change = ((weight[0] * (around.u[0] - u) + weight[1] * (around.u[1] - u)) + weight[2] * (around.u[2] - u)) +
                weight[3] * (around.u[3] - u);
  if (any(sum > one)) change = change / larger(sum, one);
  const Real mean = u + change;
  if (law.bed > 0.0) {
    const Real across = constant<Real>(0.5) * (around.inflow[2] - around.inflow[3]);
    const Real part = constant<Real>(law.dt) * bed_rate(law, mean, across, height);
    const Real slower = mean / (one + (constant<Real>(law.dt * law.calm) + part));
    return {slower, slower * part};
  }
  if (law.calm > 0.0) return {mean / (one + constant<Real>(law.dt) * constant<Real>(law.calm)), none};
  return {mean, none};
}

// Sums over the links of a span. (W5), (W6): D delta = sum of c delta of the others + rhs, with D = S + sum of H.
template <class Real> struct SpanSums {
  Real steepest{}, beside_full{}, inflow{};
  Real diagonal{}, rhs{};

  // Heads of this span and the other; `inward` is the flux into this one by the velocity before pressure.
  MDANIM_ALWAYS_INLINE void look(const Real &head, const Real &other, const Real &wet)
  {
    const Real difference = head - other;
    steepest = pick(wet > Real{}, larger(steepest, larger(difference, Real{} - difference)), steepest);
  }
  // The same where some spans are full: their heads do not give a slope.
  MDANIM_ALWAYS_INLINE void look(const Real &head, const Real &other, const Real &wet, const Real &full, const Real &other_full,
                                 const Real &inward)
  {
    const Real either = larger(full, other_full);
    look(head, other, wet - either);
    beside_full = pick(wet > Real{}, larger(beside_full, either), beside_full);
    inflow += inward;
  }
  // Over an edge liquid falls: the side below it does not push back. `tilt`: the rise from the other span to this one.
  MDANIM_ALWAYS_INLINE void couple(const Real &head, const Real &other, const Real &edge, const Real &height, double tilt)
  {
    const auto below = head < edge;
    diagonal += pick(below, Real{}, height);
    rhs -= pick(below, Real{}, height * ((head - larger(other, edge)) + constant<Real>(tilt)));
  }
};

constexpr double POROUS = 0.999;    // d volume/d height of columns that solids partly fill is less

// (W5) A free span: its head is that of its surface and the head that its rise takes.
template <class Real>
MDANIM_ALWAYS_INLINE Real free_stiffness(const WaveLaw &law, const Real &steepest, const Real &volume, const Real &slope)
{
  const Real none = constant<Real>(0.0), one = constant<Real>(1.0);
  const Real part = smaller(one, larger(none, constant<Real>(2.0) - steepest * constant<Real>(1.0 / law.breaking)));
  const Real smooth = pick(slope < constant<Real>(POROUS), none, part);    // none in columns that solids partly fill
  return slope / larger(constant<Real>(law.dt * law.dt), smooth * constant<Real>(law.inertia) * volume);
}

// (W6) A full span: the yield of its roof, and the liquid that it has to let out.
template <class Real>
MDANIM_ALWAYS_INLINE Real full_rhs(const WaveLaw &law, const Real &volume, const Real &capacity, const Real &coming,
                                   const Real &inflow)
{
  const Real excess = constant<Real>(law.overfull) * (volume - capacity) - coming * constant<Real>(law.share);
  return (excess + inflow) / constant<Real>(law.dt * law.dt);
}

// Coupling of two spans in the system, before it is scaled.
template <class Real>
MDANIM_ALWAYS_INLINE Real coupling(const Real &head_a, const Real &head_b, const Real &edge, const Real &height)
{ return pick(smaller(head_a, head_b) < edge, Real{}, height); }

// (W7) The head that pushes: for free spans not beside full ones, all except a part of the head that the rise takes.
template <class Real>
MDANIM_ALWAYS_INLINE Real pushing_head(const WaveLaw &law, const Real &head, const Real &delta, const Real &volume,
                                       const Real &full, const Real &beside_full)
{
  const Real none = constant<Real>(0.0), one = constant<Real>(1.0);
  const Real most = constant<Real>(0.5 / (law.dt * law.dt)) / larger(one, volume);
  const Real part = pick(larger(full, beside_full) > none, none, smaller(constant<Real>(law.quick), most));
  return smaller(larger(head + (one - part) * delta, head - constant<Real>(law.slam)), constant<Real>(law.height + law.slam));
}

// (W8) Inertia of liquid that turns up or down at the mouth of a duct, beyond that of columns, as a length of the duct. `above`:
// liquid above its roof; `open`: its height; `wide`: the width of the arm. In a narrow arm columns have none of their own.
inline double mouth_inertia(double above, double open, double wide, bool narrow)
{
  const double as_one = (narrow ? above + open / 3.0 : 2.0 / 3.0 * above) / wide;
  const double y = root(root(1.0 + 1.15 * above / open));
  const double turns = 16.0 / 3.141592653589793 * (y - 1.0) / (y + 1.0);    // 2/pi of the logarithm: into a wide arm
  return open * root(as_one * as_one + turns * turns);
}

template <class Real> struct UpwindFlux {
  Real u, units;    // velocity; units that pass in this sub-update, a whole number
};

// Rounds to the nearest whole number, for numbers below 2^51.
template <class Real> MDANIM_ALWAYS_INLINE Real whole(const Real &a)
{
  const Real big = constant<Real>(6755399441055744.0);    // 1.5 * 2^52
  return (a + big) - big;
}

// (W8) Pressure moves the liquid, and the acceleration of the basin leaves it behind; the flux is that of the upwind opening, in
// whole units. `ease`: inertia of the link over all that it moves.
template <class Real, class Opening>
MDANIM_ALWAYS_INLINE UpwindFlux<Real> pushed(const WaveLaw &law, const Real &u, const Real &wet, const Real &phi_a,
                                             const Real &phi_b, const Real &level_a, const Real &level_b, const Real &edge,
                                             double tilt, double ease, const Opening &opening)
{
  const Real none = constant<Real>(0.0), most = constant<Real>(law.fastest);
  const Real faster = u - constant<Real>(law.dt * ease) * ((larger(phi_b, edge) - larger(phi_a, edge)) + constant<Real>(tilt));
  const Real held = smaller(larger(faster, none - most), most);
  const Real height = opening(pick(held > none, level_a, level_b));
  const auto flows = smaller(wet, height) > none;
  return {pick(flows, held, none), pick(flows, whole(height * held * constant<Real>(law.dt * law.units_per_cell)), none)};
}

// (W9) Units that pass from and to a span.
template <class Real> struct SpanFluxes {
  Real in{}, out{};

  MDANIM_ALWAYS_INLINE void add(const Real &inward)
  {
    in += larger(inward, Real{});
    out += larger(Real{} - inward, Real{});
  }
  // Shares of the leaving and of the entering flux, so that the content stays between 0 and `most`: 1, or less by more than
  // rounding.
  MDANIM_ALWAYS_INLINE Real out_share(const Real &content) const
  { return pick(out > content, content / larger(out, constant<Real>(1.0)) * constant<Real>(1.0 - 1e-12), constant<Real>(1.0)); }
  MDANIM_ALWAYS_INLINE Real in_share(const Real &content, const Real &most) const
  {
    const Real room = larger(most - content + out, Real{});
    return pick(in > room, room / larger(in, constant<Real>(1.0)) * constant<Real>(1.0 - 1e-12), constant<Real>(1.0));
  }
};

// (W9) A flux that is scaled down, towards 0.
template <class Real> MDANIM_ALWAYS_INLINE Real scaled_down(const Real &units, const Real &share)
{
  const Real none = constant<Real>(0.0), one = constant<Real>(1.0);
  const Real size = larger(units, none - units), less = size * share, near = whole(less);
  const Real down = near - pick(near > less, one, none);
  return pick(share < one, pick(units < none, none - down, down), units);
}

}    // namespace mdanim
