// SPDX-License-Identifier: GPL-2.0-only
// How far particles may still go before lists must be made anew.

#pragma once

#include "geometry/boxes.h"
#include "numbers/vec3.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>

namespace mdanim {

// How far a particle may go from its place at the last rebuild of lists: in total, and without the drift of all particles.
// Contact depends on distances between particles only, so objects that fly together need no new lists.
struct SafeDisplacement {
  double absolute, relative;

  void include(const SafeDisplacement &other)
  {
    absolute = std::min(absolute, other.absolute);
    relative = std::min(relative, other.relative);
  }
  double least() const { return std::min(absolute, relative); }
  double most() const { return std::max(absolute, relative); }
};

// A rank's part of the box along one axis. A side of the box that `follows` moves with the particles.
struct BoxShare {
  double box_low, box_high, low, high;
  bool follows_low, follows_high;
};

// The budget: the distance that particles may still go until a fix or a rank must look at them again. It is measured from where
// they are, and spent step by step by the displacement of the fastest. Positions are compared again only when it is used up. All
// ranks call each function together: `least` replaces each number by the smallest of all ranks.
class DisplacementBudget {
 public:
  using Least = std::function<void(double *numbers, int count)>;
  static constexpr double OVERFLOW = std::numeric_limits<double>::infinity();    // spent on one rank, noticed by all

  // For a rank that is alone, and for one of several. The latter also gives its shares of the box along the three axes before
  // every limit.
  void set_alone();
  void set_ranks(Least least);
  void set_shares(const std::array<BoxShare, 3> &of_rank) { shares = of_rank; }
  // Limits are half of the skin, or more where no participant needs lists until then.
  void set_limits(double half_skin, const SafeDisplacement &participants);
  double farthest() const { return limits.most(); }

  // Measures particles of this rank: i is at where(i), and was at then[i] when lists were made.
  template <class Where> void measure(int particles, Where where, const double *const *then);
  void measure_unmoved() { left = limits.least(); }    // for a rank that is alone
  // Spends `way`. Returns whether some of the budget is left on every rank.
  bool spend(double way);
  // Lists are new: the budget is spent from here on. `build` is the number of the lists.
  void begin(long build);
  void forget() { begun_with = -1; }
  // Whether so little of the budget is left that lists had better be made at once.
  bool nearly_spent() const { return left <= SOON * whole; }
  bool overflowed() const { return left == -OVERFLOW; }

 private:
  static constexpr double SOON = 0.2;    // part of the whole budget
  // Displacements of the particles of a rank since lists were made.
  struct Moved {
    double most = 0.0;        // square of the longest displacement
    Box displacement, now;    // boxes around all displacements and positions
  };
  void set_left(const Moved &here);
  double way_to_strangers(const Box &own, const Box &all) const;

  bool alone = true;
  Least least;
  std::array<BoxShare, 3> shares = {};
  double narrowest[3] = {};    // part of the box that a rank has along each axis, the least of all
  double half_skin = 0.0;
  SafeDisplacement limits = {0.0, 0.0};
  double left = 0.0, whole = 0.0;
  long begun_with = -1;
};

template <class Where> void DisplacementBudget::measure(int particles, Where where, const double *const *then)
{
  Moved moved;
  for (int i = 0; i < particles; ++i) {
    const Vec3 here = where(i), d = here - vec3(then[i]);
    const double of_box[] = {d.x, d.y, d.z}, at[] = {here.x, here.y, here.z};
    moved.most = std::max(moved.most, dot(d, d));
    moved.displacement.include(of_box);
    if (!alone) moved.now.include(at);
  }
  set_left(moved);
}

}    // namespace mdanim
