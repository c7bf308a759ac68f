// SPDX-License-Identifier: GPL-2.0-only

#include "styles/near_cells.h"

#include "atom.h"
#include "error.h"
#include "fmt/format.h"

#include <algorithm>

namespace mdanim {

// Threads look at chunks of particles, whose cells are joined in the order of chunks.
void NearCells::find(const Threads &threads, const std::vector<int> &near, const ParticleTable &table, const std::string &fix)
{
  constexpr long CHUNK = 2048;                         // particles
  constexpr double NS_OF_CHUNK = 5e4, PLACING = 10;    // [ns], about
  of_particle.assign(8 * near.size(), -1);
  number.assign(atom->nlocal, -1);
  for (std::size_t n = 0; n < near.size(); ++n) number[near[n]] = static_cast<int>(n);
  const auto number_at = [this](int at) { return at >= 0 && at < atom->nlocal ? number[at] : -1; };

  int *const *corners = table.rows(lmp);
  const bool knows_layers = table.width(lmp) == 8;
  const long all = atom->nlocal + atom->nghost;
  struct Chunk {
    std::vector<Cell> cells;
    int lost_by = -1, lost = 0;    // a particle whose cell has a corner out of reach
  };
  std::vector<Chunk> chunks((all + CHUNK - 1) / CHUNK);
  threads.parts(static_cast<long>(chunks.size()), NS_OF_CHUNK, [&](long from, long to) {
    for (long i = from * CHUNK; i < std::min(all, to * CHUNK); ++i) {
      if (corners[i][0] == 0) continue;
      Chunk &chunk = chunks[i / CHUNK];
      Cell cell{{atom->map(atom->tag[i])}, knows_layers ? corners[i][7] : -1};
      for (int k = 1; k < 8; ++k) cell.corner[k] = atom->map(corners[i][k - 1]);
      if (std::all_of(cell.corner, cell.corner + 8, [&](int at) { return number_at(at) < 0; })) continue;
      for (int k = 1; k < 8; ++k)
        if (cell.corner[k] < 0) chunk.lost_by = static_cast<int>(i), chunk.lost = corners[i][k - 1];
      chunk.cells.push_back(cell);
    }
  });

  cells.clear();
  for (const Chunk &chunk : chunks) {
    if (chunk.lost_by >= 0)
      error->one(FLERR, "{}: particle {}, a corner of the lattice cell of particle {}, is out of reach; raise comm_modify cutoff",
                 fix, chunk.lost, atom->tag[chunk.lost_by]);
    cells.insert(cells.end(), chunk.cells.begin(), chunk.cells.end());
  }
  threads.parts(static_cast<long>(cells.size()), PLACING, [&](long from, long to) {
    for (long n = from; n < to; ++n)
      for (int k = 0; k < 8; ++k)
        if (const int at = number_at(cells[n].corner[k]); at >= 0) of_particle[8 * at + k] = static_cast<int>(n);
  });
}

}    // namespace mdanim
