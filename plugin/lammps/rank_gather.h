// SPDX-License-Identifier: GPL-2.0-only
// Data of each rank, gathered on all of them.

#pragma once

#include "fmt/format.h"

#include <climits>
#include <mpi.h>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace mdanim {

// The values of all ranks, one rank after the other. Throws std::runtime_error on all ranks when they are too much for one
// message.
template <class T> std::vector<T> gather(MPI_Comm world, const std::vector<T> &here)
{
  int ranks = 1;
  MPI_Comm_size(world, &ranks);
  if (ranks == 1) return here;
  double all_bytes = 0.0, bytes = static_cast<double>(here.size() * sizeof(T));
  MPI_Allreduce(&bytes, &all_bytes, 1, MPI_DOUBLE, MPI_SUM, world);
  if (all_bytes > INT_MAX)
    throw std::runtime_error(fmt::format("a state of {:.3g} bytes is too large to be gathered from ranks", all_bytes));
  const int size = static_cast<int>(bytes);
  std::vector<int> sizes(ranks), starts(ranks);
  MPI_Allgather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, world);
  std::exclusive_scan(sizes.begin(), sizes.end(), starts.begin(), 0);
  std::vector<T> all((starts.back() + sizes.back()) / sizeof(T));
  MPI_Allgatherv(here.data(), size, MPI_BYTE, all.data(), sizes.data(), starts.data(), MPI_BYTE, world);
  return all;
}

}    // namespace mdanim
