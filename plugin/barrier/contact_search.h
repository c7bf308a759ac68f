// SPDX-License-Identifier: GPL-2.0-only
// The search from boxes that meet to pairs of particles that may touch. Wcislo 1999, eq. (3.14), (3.15).

#pragma once

#include "barrier/pair_filter.h"
#include "geometry/aligned_array.h"
#include "geometry/boxes.h"

#include <utility>
#include <vector>

namespace mdanim {

// Finds the pairs of particles of different objects that may come into reach of each other before lists are rebuilt. It is given
// the boxes of all objects and the pairs of objects that meet, then the particles near a partner's box; run() then finds their
// pairs. No two particles come nearer to each other by more than the skin until the next rebuild, so pairs within reach + skin
// are enough.
class ContactSearch {
 public:
  struct Settings {
    double range, skin;    // `range`: the longest reach of all pairs, and the skin
    double thin_ratio;
    const PairFilter *filter;
  };
  struct Particle {
    int index, tag;    // in the arrays of LAMMPS
    int object;        // number of its box
    int role;          // Role
    bool moves;        // whether this rank adds forces to it
    double reach;
    const double *x;
  };
  struct Pair {
    int low, high;    // places in particles()
  };

  ContactSearch(const std::vector<Box> &boxes, const std::vector<std::pair<int, int>> &meeting, const Settings &settings);

  bool is_near(int object, const double *x) const { return zone[object].contains(x); }    // x is within range of a partner's box
  void add(const Particle &particle) { near.push_back(particle); }
  void run();

  const std::vector<Particle> &particles() const { return near; }    // ascending by tag
  const std::vector<Pair> &pairs() const { return found; }           // ascending by the lower tag, then by the higher one
  double reach_of(const Particle &one, const Particle &other) const;

 private:
  // Particles of one object, copied one after the other.
  struct ObjectParticles {
    Positions place;
    std::vector<int> rank;    // in `near`

    int size() const { return static_cast<int>(rank.size()); }
    void clear(int room);
    void add(const double *at, int n);
  };

  void sort_by_object();
  void search(int seeking, int guarding, bool thin_too);
  void pick(ObjectParticles &side, int object, int wanted, const Box &inside) const;
  void look(int seeker, const ObjectParticles &side, int from, int to, bool thin_too);
  void consider(int a, int b, double r2, bool thin_too);
  template <class Key> void sort_found(Key key);

  const std::vector<Box> &boxes;
  const std::vector<std::pair<int, int>> &meeting;
  const Settings set;
  std::vector<Box> zone;    // for each object: the zone around all places within range of a partner's box
  std::vector<Particle> near;
  std::vector<int> begin, of_object;    // those of object n, by their places in `near`: of_object[begin[n]] to [begin[n + 1] - 1]
  std::vector<Pair> found;
  ObjectParticles seekers, guards, sorted;
  std::vector<int> close;
};

}    // namespace mdanim
