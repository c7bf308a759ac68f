// SPDX-License-Identifier: GPL-2.0-only
// The particles of one of those participants of passes that depend on positions alone.

#pragma once

#include "geometry/aligned_array.h"

#include <cstddef>
#include <cstring>
#include <vector>

namespace mdanim {

struct ForceProvider {
  struct Ghost {
    int particle, to;    // `particle` in LAMMPS's order
  };
  std::vector<int> particle;    // in the order of blocks, any one for a ghost
  std::vector<char> in_row;     // whether four from here on follow each other in that order, for each fourth one
  std::vector<Ghost> ghosts;
  std::vector<long> slot;    // of each particle's force in `external_force`; of ghosts all the same one, in a row of no block

  // To be called when all particles are there.
  void find_rows()
  {
    for (std::size_t k = 0; k + 4 <= particle.size(); k += 4)
      in_row.push_back(particle[k + 1] == particle[k] + 1 && particle[k + 2] == particle[k] + 2 &&
                       particle[k + 3] == particle[k] + 3);
  }

  // Places from arrays of blocks, and from LAMMPS's for ghosts.
  template <class Arrays> void tell_places(const Arrays &x, const double *const *of_ghosts, Positions &to) const
  {
    to.make_room(particle.size());
    for (int d = 0; d < 3; ++d) {
      const double *const from = x[d];
      double *next = to.along[d].data();
      const int *i = particle.data(), *const end = i + particle.size();
      for (const char is_in_row : in_row) {
        if (is_in_row)
          std::memcpy(next, from + *i, 4 * sizeof(double));    // not std::copy_n(), which calls a function
        else
          for (int k = 0; k < 4; ++k) next[k] = from[i[k]];
        next += 4, i += 4;
      }
      while (i < end) *next++ = from[*i++];
    }
    for (const auto &[i, place] : ghosts) to.put(place, of_ghosts[i]);
  }
};

}    // namespace mdanim
