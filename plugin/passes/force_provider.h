// SPDX-License-Identifier: GPL-2.0-only
// The particles of one of those participants of passes that depend on positions alone.

#pragma once

#include "geometry/aligned_array.h"
#include "threads/team.h"

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
  void tell_places(const Threads &threads, const double *const *x, const double *const *of_ghosts, Positions &to) const
  {
    to.make_room(particle.size());
    threads.parts(static_cast<long>(in_row.size()), 4.0 * PARTICLE, [&](long from, long end) { tell_fours(from, end, x, to); });
    for (std::size_t n = 4 * in_row.size(); n < particle.size(); ++n)
      for (int d = 0; d < 3; ++d) to.along[d].data()[n] = x[d][particle[n]];
    for (const auto &[i, place] : ghosts) to.put(place, of_ghosts[i]);
  }

 private:
  static constexpr double PARTICLE = 3.0;    // time to copy a place [ns], approximately

  void tell_fours(long from, long end, const double *const *x, Positions &to) const
  {
    for (int d = 0; d < 3; ++d) {
      double *next = to.along[d].data() + 4 * from;
      const int *i = particle.data() + 4 * from;
      for (long four = from; four < end; ++four, next += 4, i += 4)
        if (in_row[four])
          std::memcpy(next, x[d] + *i, 4 * sizeof(double));    // not std::copy_n(), which calls a function
        else
          for (int k = 0; k < 4; ++k) next[k] = x[d][i[k]];
    }
  }
};

}    // namespace mdanim
