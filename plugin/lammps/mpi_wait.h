// SPDX-License-Identifier: GPL-2.0-only
// Waiting for other ranks.

#pragma once

#include <chrono>
#include <mpi.h>
#include <thread>

namespace mdanim {

// Like MPI_Waitall, but a rank that has waited for long yields its processor: there may be more processes than processors, and
// the awaited process may be among those that have none.
inline void wait_for(int count, MPI_Request *requests)
{
  using namespace std::chrono;
  constexpr auto LONG = microseconds(50), NAP = microseconds(20);
  int done = 0;
  for (const auto start = steady_clock::now(); !done; MPI_Testall(count, requests, &done, MPI_STATUSES_IGNORE))
    if (steady_clock::now() - start > LONG) std::this_thread::sleep_for(NAP);
}

}    // namespace mdanim
