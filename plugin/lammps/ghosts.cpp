// SPDX-License-Identifier: GPL-2.0-only
// Finds which rank needs which particles of another, and sends them.

#include "lammps/ghosts.h"

#include "lammps/mpi_wait.h"

#include <algorithm>

namespace mdanim {

void Ghosts::survey(MPI_Comm world, const std::vector<Home> &home, const SimdBlocks &blocks)
{
  int ranks = 0;
  MPI_Comm_size(world, &ranks);
  std::vector<int> asks(ranks, 0), asked(ranks, 0);    // number of particles asked from each rank, and by each rank from this one
  for (const Home &h : home) ++asks[h.rank];
  MPI_Alltoall(asks.data(), 1, MPI_INT, asked.data(), 1, MPI_INT, world);

  std::vector<int> ask_from(ranks + 1, 0), asked_from(ranks + 1, 0);
  for (int r = 0; r < ranks; ++r) {
    ask_from[r + 1] = ask_from[r] + asks[r];
    asked_from[r + 1] = asked_from[r] + asked[r];
  }
  std::vector<int> want(home.size()), wanted(asked_from.back()), next(ask_from);
  others.clear();
  for (int r = 0; r < ranks; ++r)
    if (asks[r] || asked[r]) others.push_back({r, {}, {}, {}, {}});
  const auto of_rank = [this](int r) {
    return std::lower_bound(others.begin(), others.end(), r, [](const Rank &other, int rank) { return other.rank < rank; });
  };
  for (std::size_t g = 0; g < home.size(); ++g) {
    want[next[home[g].rank]++] = home[g].index;
    of_rank(home[g].rank)->heard.push_back(blocks.ghost_places()[g]);
  }
  MPI_Alltoallv(want.data(), asks.data(), ask_from.data(), MPI_INT, wanted.data(), asked.data(), asked_from.data(), MPI_INT,
                world);
  for (Rank &other : others)
    for (int k = asked_from[other.rank]; k < asked_from[other.rank + 1]; ++k) other.told.push_back(blocks.place_of(wanted[k]));
}

void Ghosts::meet(MPI_Comm world, SimdBlocks &blocks, bool velocities)
{
  const std::size_t numbers = velocities ? 6 : 3;
  requests.clear();
  for (Rank &other : others) {
    other.in.resize(numbers * other.heard.size());
    requests.emplace_back();
    MPI_Irecv(other.in.data(), static_cast<int>(other.in.size()), MPI_DOUBLE, other.rank, 0, world, &requests.back());
  }
  for (Rank &other : others) {
    other.out.resize(numbers * other.told.size());
    blocks.pack(other.told, velocities, other.out.data());
    requests.emplace_back();
    MPI_Isend(other.out.data(), static_cast<int>(other.out.size()), MPI_DOUBLE, other.rank, 0, world, &requests.back());
  }
  wait_for(static_cast<int>(requests.size()), requests.data());
  for (const Rank &other : others) blocks.unpack(other.heard, velocities, other.in.data());
}

std::size_t Ghosts::bytes() const
{
  std::size_t sum = 0;
  for (const Rank &other : others)
    sum += (other.told.capacity() + other.heard.capacity()) * sizeof(int) +
           (other.out.capacity() + other.in.capacity()) * sizeof(double);
  return sum;
}

}    // namespace mdanim
