// SPDX-License-Identifier: GPL-2.0-only
// Whether a contact begins between a point and a host that is a lattice: the sides of the host that face the point, and its depth
// below them. Templates over Real (numbers/real.h): contact_birth.h judges one point, contact_kernel_of_set.cpp several.

#pragma once

#include "contact/contact_push.h"

namespace mdanim {

constexpr double PRESSED = 0.5;          // cells are assumed to be pressed to half at most: motion in space over that in X
constexpr double LEAST_COSINE = 0.45;    // between the outward normals of the point and of a side that faces it, negated
constexpr double DEEPEST_BIRTH = 0.5;    // cells
constexpr double WHOLE_CELL = 0.7;       // volume over that of a cell above which one step of Newton's method tells a place
constexpr double NEAR_PLACE = 0.1;       // cells that a guess may be away from the last one

// The point and its host, as judge_sides() needs them.
template <class Real> struct Judge {
  const Lattice &host;
  const Ramps &ramps;
  double radius;         // of the surface around the point [m]
  Vec<Real> X_centre;    // of its area
  const Spot<Real> &spot;
  Vec<Real> normal;       // outward, in space
  Real turning, press;    // edge of the cell that turns it [m]; how much X may change with a motion
  Real off;               // error of X, in cells
  bool faces_all;         // the surface around the point has no normal
};

// Flags are 0 or 1.
template <class Real> struct Judged {
  Real side = constant<Real>(-1.0);    // that it is below and that faces it, -1 for none
  Real depth{};                        // below it [m]
  Vec<Real> inward;                    // the gradient of that, in space
  Real open{};                         // sum of 2^s of the sides s in which the point would have a potential if it faced them
  Real slack = constant<Real>(__builtin_inf());    // a motion that cannot yet begin a contact [m]
  Real is_shut{};                                  // above a side that faces it
  Real is_unsure{};                                // a contact may begin where the place of the point is guessed
};

// depth(s) is the Depth below side s, covered(s) how far the point is outside of the open part of the side, in cells.
template <bool CUBOID, class Real, class DepthOf, class CoveredOf>
MDANIM_ALWAYS_INLINE Judged<Real> judge_sides(const Judge<Real> &of, const DepthOf &depth_of, const CoveredOf &covered_of)
{
  const Real far = 1e-5 + of.off * of.off, turn = 1e-3 + 0.5 * of.off,
             yes = constant<Real>(1.0);    // errors of a guess, in cells
  const double h = of.host.spacing;
  Real surely_shut{}, may_face{}, until{}, best = constant<Real>(__builtin_inf());
  Judged<Real> found;
#pragma GCC unroll 6
  for (int s = 0; s < (CUBOID ? 6 : 1); ++s) {
    Depth<Real> below = depth_of(s);
    below.value += constant<Real>(of.radius);
    const Real depth = below.value / h;    // in cells
    const Vec<Real> inward = of.spot.gradient(below.slope);
    const Real cosine = of.faces_all ? yes : dot(of.normal, inward) / root(dot(inward, inward));
    // Smallest change before the side can begin a contact, in cells: the largest of these three.
    Real apart = -depth;
    const Real turned = PRESSED * (LEAST_COSINE - cosine);
    if (CUBOID)
#pragma GCC unroll 3
      for (int d = 0; d < 3; ++d) {
        if (d == s / 2) continue;
        const Real inside = smaller(component(of.X_centre, d), of.host.cells[d] - component(of.X_centre, d));
        apart = larger(apart, of.ramps.from[d] - inside);
      }
    found.open = pick((apart <= 0.0) | (turned > apart), found.open + static_cast<double>(1 << s), found.open);
    const Real covered = covered_of(s);
    found.is_unsure = pick(larger(covered, -covered) > far + of.off, found.is_unsure, yes);
    found.slack = smaller(found.slack, of.press * larger(larger(h * apart, of.turning * turned), h * (depth - DEEPEST_BIRTH)));
    const auto acts = covered < 0.0;    // else another held body is there, and no point reaches this side
    surely_shut = pick(acts & (turned < -turn) & (depth < -far), yes, surely_shut);
    may_face = pick(acts & (turned < turn) & (apart < far) & (depth < DEEPEST_BIRTH + far), yes, may_face);
    const auto faces = acts & (cosine >= LEAST_COSINE), is_above = faces & (depth <= 0.0);
    found.is_shut = pick(is_above, yes, found.is_shut);
    const Real opens = smaller(-of.press * depth * h, 0.5 * of.press * of.turning * (cosine - LEAST_COSINE));
    until = pick(is_above, larger(until, opens), until);
    const auto is_best = faces & (depth > 0.0) & (depth / cosine < best);
    best = pick(is_best, depth / cosine, best);
    found.side = pick(is_best, constant<Real>(s), found.side);
    found.depth = pick(is_best, below.value, found.depth);
    found.inward = {pick(is_best, inward.x, found.inward.x), pick(is_best, inward.y, found.inward.y),
                    pick(is_best, inward.z, found.inward.z)};
  }
  found.is_unsure = pick((surely_shut > 0.0) | (may_face <= 0.0), found.is_unsure, yes);
  found.slack = pick(found.is_shut > 0.0, larger(found.slack, until), found.slack);
  return found;
}

}    // namespace mdanim
