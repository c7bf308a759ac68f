// SPDX-License-Identifier: GPL-2.0-only
// How far particles may still go before lists must be made anew.

#ifndef MDANIM_DISPLACEMENT_BUDGET_H
#define MDANIM_DISPLACEMENT_BUDGET_H

#include "geometry/boxes.h"
#include "numbers/vec3.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

namespace mdanim {

// How far a particle may go from where it was when lists were made: all told, and with the drift of all particles taken off.
// Contact looks at distances between particles alone, so what flies along together needs no new lists.
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

// A rank's part of the box along one axis. A side of the box that `follows` goes where particles are.
struct BoxShare {
  double box_low, box_high, low, high;
  bool follows_low, follows_high;
};

// What is left of the way that particles may go until a fix or a rank must look at them again. It is measured from where they
// are, and spent step by step by the way of the fastest; only when it is used up positions are compared again. All ranks call
// each function together: `least` puts the least number of all ranks in the place of each.
class DisplacementBudget {
 public:
  using Least = std::function<void(double *numbers, int count)>;
  static constexpr double OVERFLOW = std::numeric_limits<double>::infinity();    // spent on one rank, is heard by all

  // Of a rank that is alone, or of one of several, which also tells its shares of the box along the three axes, before every
  // limit.
  void set_alone();
  void set_ranks(Least least);
  void set_shares(const std::array<BoxShare, 3> &of_rank) { shares = of_rank; }
  // Half of the skin, and farther where no participant needs lists until then.
  void set_limits(double half_skin, const SafeDisplacement &participants);
  double farthest() const { return limits.most(); }

  // As the particles of this rank stand now, particle i at where(i), that stood at then[i] when lists were made.
  template <class Where> void measure(int particles, Where where, const double *const *then);
  void measure_unmoved() { left = limits.least(); }    // of a rank that is alone
  // Whether some is left on every rank after going so far.
  bool spend(double way);
  // Lists are new: from here on the budget is spent. `build` is their number.
  void begin(long build);
  void forget() { begun_with = -1; }
  // Whether so little is left, of a budget that is not used up, that lists had better be made at once.
  bool nearly_spent() const { return left <= SOON * whole; }
  bool overflowed() const { return left == -OVERFLOW; }

 private:
  static constexpr double SOON = 0.2;    // part of the whole
  // What particles of a rank have done since lists were made.
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

#endif
