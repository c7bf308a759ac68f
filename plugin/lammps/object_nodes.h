// SPDX-License-Identifier: GPL-2.0-only
// Particles of objects that a fix needs on all ranks: their places and velocities, and which of them it pushes.

#pragma once

#include "lammps/shared_motion.h"
#include "numbers/vec3.h"

#include "pointers.h"

#include <cstddef>
#include <string>
#include <vector>

namespace mdanim {

// All ranks call all functions together, but for those that are const.
class ObjectNodes : protected LAMMPS_NS::Pointers {
 public:
  static constexpr int ELSEWHERE = SharedMotion::ELSEWHERE;

  explicit ObjectNodes(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp), shared(lmp) {}

  // Nodes of an object: its particles with these numbers, counted from its lowest tag and ascending. What they belong to must
  // stay. Objects come by ascending molecule IDs.
  void append(int molecule, const std::vector<int> &particles) { objects.push_back({molecule, &particles}); }
  // Tags and masses of all nodes; objects may have changed since the last run. Raises a LAMMPS error for one that is not there;
  // `who` begins messages.
  void find(const std::string &who);
  // To be called after particles have come to other ranks or indices, when LAMMPS's map is up to date.
  void locate(const std::string &who, int groupbit);
  // To be called after particles have moved.
  void share() { shared.share(); }

  int count() const { return static_cast<int>(objects.size()); }
  int molecule(int object) const { return objects[object].molecule; }
  // Nodes of all objects stand one after the other: those of an object, from the first to the one behind the last.
  std::size_t first(int object) const { return objects[object].first; }
  std::size_t end(int object) const { return objects[object].first + objects[object].particles->size(); }
  // Whether some node of it is in the group: an object that is not has been laid aside, or is held.
  bool acts(int object) const { return objects[object].acts; }
  double mass(std::size_t node) const { return masses[node]; }
  Vec3 place(std::size_t node) const { return shared.place(row[node]); }
  Vec3 speed(std::size_t node) const { return shared.speed(row[node]); }
  int target(std::size_t node) const { return targets[node]; }    // the local particle that is pushed, or ELSEWHERE
  std::size_t bytes() const;

 private:
  struct OneObject {
    int molecule;
    const std::vector<int> *particles;
    std::size_t first = 0;
    bool acts = true;
  };
  std::vector<LAMMPS_NS::tagint> lowest_tags() const;
  void find_masses(const std::string &who, const std::vector<LAMMPS_NS::tagint> &lowest);
  int object_of(int i) const;    // of a local particle; ELSEWHERE for none of these

  std::vector<OneObject> objects;
  SharedMotion shared;
  std::vector<double> masses;
  std::vector<int> number, row, targets;    // of nodes: numbers among shared particles, and where these are
};

}    // namespace mdanim
