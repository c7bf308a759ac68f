// SPDX-License-Identifier: GPL-2.0-only

#include "lammps/near_cells.h"

#include "atom.h"
#include "error.h"
#include "fmt/format.h"

#include <algorithm>

namespace mdanim {

namespace {

// The results of find(first, end, found) over `many` numbers, chunk by chunk, shared among threads; joined in the order of
// chunks.
template <class Found, class Find>
void find_in_chunks(const Threads &threads, long many, double ns, std::vector<Found> &found, const Find &find)
{
  constexpr long CHUNK = 2048;
  std::vector<std::vector<Found>> chunks((many + CHUNK - 1) / CHUNK);
  threads.parts(static_cast<long>(chunks.size()), ns * CHUNK, [&](long from, long to) {
    for (long n = from; n < to; ++n) find(n * CHUNK, std::min(many, (n + 1) * CHUNK), chunks[n]);
  });
  found.clear();
  for (const std::vector<Found> &chunk : chunks) found.insert(found.end(), chunk.begin(), chunk.end());
}

}    // namespace

void NearCells::clear()
{
  cells.clear();
  of_particle.clear();
  all.clear();
  tags.clear();
  particles.clear();
}

// Corners are indices of particles, which are looked up again after particles have moved in the arrays.
bool NearCells::find_all(const Threads &threads, const ParticleTable &table)
{
  constexpr double PARTICLE = 25.0;    // [ns], approximately
  const long many = atom->nlocal + atom->nghost;
  if (static_cast<long>(tags.size()) == many && std::equal(tags.begin(), tags.end(), atom->tag)) return false;
  tags.assign(atom->tag, atom->tag + many);
  int *const *corners = table.rows(lmp);
  const bool knows_layers = table.width(lmp) == 8;
  find_in_chunks(threads, many, PARTICLE, all, [&](long i, long end, std::vector<Cell> &found) {
    for (; i < end; ++i) {
      if (corners[i][0] == 0) continue;
      Cell cell{{atom->map(atom->tag[i])}, knows_layers ? corners[i][7] : -1};
      for (int k = 1; k < 8; ++k) cell.corner[k] = atom->map(corners[i][k - 1]);
      found.push_back(cell);
    }
  });
  return true;
}

void NearCells::find(const Threads &threads, const std::vector<int> &near, const ParticleTable &table, const std::string &fix)
{
  constexpr double CELL = 15.0, PLACING = 10.0;    // [ns], approximately
  if (!find_all(threads, table) && near == particles) return;
  particles = near;
  of_particle.assign(8 * near.size(), -1);
  number.assign(atom->nlocal, -1);
  for (std::size_t n = 0; n < near.size(); ++n) number[near[n]] = static_cast<int>(n);
  const auto number_at = [this](int at) { return at >= 0 && at < atom->nlocal ? number[at] : -1; };
  find_in_chunks(threads, static_cast<long>(all.size()), CELL, cells, [&](long n, long end, std::vector<Cell> &found) {
    for (; n < end; ++n)
      if (std::any_of(all[n].corner, all[n].corner + 8, [&](int at) { return number_at(at) >= 0; })) found.push_back(all[n]);
  });
  for (const Cell &cell : cells)
    for (int k = 1; k < 8; ++k)
      if (cell.corner[k] < 0)
        error->one(FLERR,
                   "{}: particle {}, a corner of the lattice cell of particle {}, is out of reach; raise comm_modify cutoff", fix,
                   table.rows(lmp)[cell.corner[0]][k - 1], atom->tag[cell.corner[0]]);
  threads.parts(static_cast<long>(cells.size()), PLACING, [&](long from, long to) {
    for (long n = from; n < to; ++n)
      for (int k = 0; k < 8; ++k)
        if (const int at = number_at(cells[n].corner[k]); at >= 0) of_particle[8 * at + k] = static_cast<int>(n);
  });
}

}    // namespace mdanim
