// SPDX-License-Identifier: GPL-2.0-only
// The objects: particles with one molecule ID are one object.

#pragma once

#include "geometry/boxes.h"
#include "lammps/rank_gather.h"

#include "atom.h"
#include "lmptype.h"

#include <algorithm>
#include <mpi.h>
#include <utility>
#include <vector>

namespace LAMMPS_NS {
class Fix;
class LAMMPS;
}    // namespace LAMMPS_NS

namespace mdanim {

constexpr const char *NO_OBJECTS =
    "objects are told apart by molecule IDs, and there are none; use 'atom_style bond' or 'fix ID all property/atom mol'";

// Objects by ascending molecule IDs, numbered from 0, the same on all ranks; and the number of each local particle's object.
class ObjectTable {
 public:
  static constexpr int NONE = -1;

  // Called by all ranks together: the objects of these particles; an ID may occur several times.
  void make(MPI_Comm world, std::vector<LAMMPS_NS::tagint> ids_here)
  {
    make_unique(ids_here);
    known = gather(world, ids_here);
    make_unique(known);
  }
  void set(std::vector<LAMMPS_NS::tagint> ascending) { known = std::move(ascending); }

  int size() const { return static_cast<int>(known.size()); }
  LAMMPS_NS::tagint id(int number) const { return known[number]; }
  // Whether they are the same objects.
  bool operator==(const ObjectTable &other) const { return known == other.known; }
  // NONE for an ID that does not occur: objects may come and go between two rebuilds of lists.
  int number_of(LAMMPS_NS::tagint id) const
  {
    const auto found = std::lower_bound(known.begin(), known.end(), id);
    return found != known.end() && *found == id ? static_cast<int>(found - known.begin()) : NONE;
  }

  // Called by all ranks together: eq. (3.14), a box around the particles of each object for which is_among(i). unknown(i) is
  // called for such a particle whose object does not occur.
  template <class IsAmong, class Unknown>
  std::vector<Box> place(const LAMMPS_NS::Atom &atom, MPI_Comm world, const IsAmong &is_among, const Unknown &unknown)
  {
    std::vector<Box> here(known.size()), all(known.size());
    of_particle.assign(atom.nlocal, NONE);
    for (int i = 0; i < atom.nlocal;) {    // particles of an object mostly stand side by side
      const LAMMPS_NS::tagint id = atom.molecule[i];
      const int one = number_of(id);
      Box box;
      for (; i < atom.nlocal && atom.molecule[i] == id; ++i) {
        if (!is_among(i)) continue;
        if (one == NONE) {
          unknown(i);
          continue;
        }
        of_particle[i] = one;
        box.include(atom.x[i]);
      }
      if (!box.empty()) here[one].unite(box);
    }
    MPI_Allreduce(here.data(), all.data(), 6 * size(), MPI_DOUBLE, MPI_MIN, world);
    return all;
  }
  // Object of a local particle, set by place(); NONE where it is not among them.
  int operator[](int i) const { return of_particle[i]; }
  std::size_t bytes() const { return known.capacity() * sizeof(LAMMPS_NS::tagint) + of_particle.capacity() * sizeof(int); }

 private:
  static void make_unique(std::vector<LAMMPS_NS::tagint> &ids)
  {
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  }

  std::vector<LAMMPS_NS::tagint> known;
  std::vector<int> of_particle;
};

// Called by all ranks together: raises a LAMMPS error unless each of these molecule IDs, which a word of the fix names, occurs.
void need_molecules(const LAMMPS_NS::Fix *fix, LAMMPS_NS::LAMMPS *lmp, const char *word, const std::vector<int> &ids);

// Raises a LAMMPS error unless the local particle i, which the fix acts on, belongs to an object. `or_else`: another way out.
void need_object(const LAMMPS_NS::Fix *fix, LAMMPS_NS::LAMMPS *lmp, int i, const char *or_else = "");

}    // namespace mdanim
