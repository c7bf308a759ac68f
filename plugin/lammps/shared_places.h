// SPDX-License-Identifier: GPL-2.0-only
// Places of particles in contact, of which every rank needs all.

#pragma once

#include "contact/contact_world.h"
#include "geometry/aligned_array.h"

#include "pointers.h"

#include <cstddef>
#include <vector>

namespace mdanim {

// Particles of all ranks in ascending order: all ranks have the same numbers of them. All ranks call all functions together.
class SharedPlaces : protected LAMMPS_NS::Pointers {
 public:
  explicit SharedPlaces(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp) {}

  // Takes the particles of this rank, ascending, and returns those of all ranks.
  std::vector<ContactParticle> share(const std::vector<ContactParticle> &own);
  // Number of the n-th particle of this rank among all.
  int number_of(std::size_t n) const { return number[first + n]; }
  // Places of all, from those of this rank's particles.
  Coordinates places(const Coordinates &own);
  std::size_t bytes() const { return all_places.bytes() + number.capacity() * sizeof(int); }

 private:
  std::vector<int> number;            // of the particles of all ranks, rank by rank
  int first = 0;                      // entry of this rank
  std::vector<int> counts, starts;    // of the coordinates that ranks send, three for each particle
  std::vector<double> sent, received;
  Positions all_places;
};

}    // namespace mdanim
