// SPDX-License-Identifier: GPL-2.0-only
// The particles of LAMMPS near a liquid.

#pragma once

#include "liquid/basin.h"

#include "pointers.h"

#include <limits>
#include <vector>

namespace mdanim {

// Local particles that can come near the liquid until they are listed again. Passes may hold the positions of most of them: the
// arrays of LAMMPS are then split.
class NearLiquid : protected LAMMPS_NS::Pointers {
 public:
  explicit NearLiquid(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp) {}

  // Lists the particles of a group, but not those of the group `still`, that can come near before they have moved by `margin`;
  // all of them unless lists of LAMMPS are rebuilt promptly. Returns false where that was quick, because none has come. Called by
  // all ranks together.
  bool find(const Basin &basin, int group, int still, double margin, bool prompt);
  // Between two runs anything may have been changed; `is_split` may be true when an error has broken off passes.
  void forget() { none_anywhere = is_split = false; }
  // Whether the liquid has risen above the height for which particles were listed.
  bool outgrown(const Basin &basin) const { return basin.height(basin.top()) > listed_top; }
  void forget_lowest() { lowest = -std::numeric_limits<double>::infinity(); }

  const std::vector<int> &all() const { return near; }
  const std::vector<int> &in_arrays() const { return is_split ? near_in_arrays : near; }
  bool none() const { return none_anywhere; }    // on any rank, before the next rebuild of lists
  const std::vector<char> &marks() const { return near_marks; }
  long long listed() const { return lists; }
  // While none is near: the way until one comes near.
  double clearance(const Basin &basin) const { return lowest - (listed_top + Basin::NEAR * basin.shape.cell.z); }

  // From now on the arrays hold only these particles; null for all. When this is called, they hold the last places of all.
  void split(const std::vector<int> *in_arrays, const Basin &basin);
  // Square of the largest speed of the particles that passes have; negative without any.
  void moved_in_passes(double fastest) { fastest_in_passes = fastest; }
  // Square of the largest speed near the liquid, of all ranks; negative without any.
  double fastest(const Basin &basin) const;
  static double top_of_near(const Basin &basin) { return basin.height(basin.top() + Basin::NEAR); }
  std::size_t bytes() const { return near.capacity() * sizeof(int); }

 private:
  double fastest_of(const std::vector<int> &these, const Basin &basin) const;

  bool none_anywhere = false;
  double listed_top = 0.0;    // of the liquid when particles were listed
  double lowest = 0.0;        // particle of this rank when lists were made
  std::vector<int> near;
  std::vector<char> near_marks;    // of all particles of this rank
  long long lists = 0;             // made so far
  bool is_split = false;
  std::vector<int> near_in_arrays;
  double fastest_in_passes = -1.0;
};

}    // namespace mdanim
