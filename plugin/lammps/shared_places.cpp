// SPDX-License-Identifier: GPL-2.0-only
// One exchange a step, of as many coordinates as at the last one.

#include "lammps/shared_places.h"

#include "lammps/rank_gather.h"

#include "comm.h"

#include <algorithm>
#include <mpi.h>
#include <numeric>

namespace mdanim {

std::vector<ContactParticle> SharedPlaces::share(const std::vector<ContactParticle> &own)
{
  counts.assign(comm->nprocs, 0);
  starts.assign(comm->nprocs, 0);
  const int coordinates = 3 * static_cast<int>(own.size());
  MPI_Allgather(&coordinates, 1, MPI_INT, counts.data(), 1, MPI_INT, world);
  std::exclusive_scan(counts.begin(), counts.end(), starts.begin(), 0);
  first = starts[comm->me] / 3;
  const std::vector<ContactParticle> particles = gather(world, own);
  std::vector<int> order(particles.size());
  std::iota(order.begin(), order.end(), 0);
  if (!std::is_sorted(particles.begin(), particles.end()))    // as it is where one rank has all particles
    std::sort(order.begin(), order.end(), [&](int p, int q) { return particles[p] < particles[q]; });
  number.resize(order.size());
  std::vector<ContactParticle> ascending;
  ascending.reserve(order.size());
  for (const int n : order) {
    number[n] = static_cast<int>(ascending.size());
    ascending.push_back(particles[n]);
  }
  return ascending;
}

Coordinates SharedPlaces::places(const Coordinates &own)
{
  if (comm->nprocs == 1) return own;
  const std::size_t many = counts[comm->me] / 3;
  sent.resize(3 * many);
  received.resize(3 * number.size());
  for (std::size_t n = 0; n < many; ++n)
    for (int d = 0; d < 3; ++d) sent[3 * n + d] = own[d][n];
  MPI_Allgatherv(sent.data(), static_cast<int>(sent.size()), MPI_DOUBLE, received.data(), counts.data(), starts.data(),
                 MPI_DOUBLE, world);
  all_places.make_room(number.size());
  for (std::size_t n = 0; n < number.size(); ++n) all_places.put(number[n], &received[3 * n]);
  return all_places.all();
}

}    // namespace mdanim
