// SPDX-License-Identifier: GPL-2.0-only
// Waiting for another thread.

#pragma once

#include <chrono>
#include <sched.h>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace mdanim {

// The time that a thread waits for work before it sleeps, and for others before it yields its processor. Longer waits gain
// nothing, and take the processor from others where there are more threads than processors.
constexpr std::chrono::microseconds PATIENCE{50};

inline void pause_processor()
{
#if defined(__SSE__)
  _mm_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

// Whether a condition becomes true before PATIENCE ends.
template <class Happens> bool wait_for(const Happens &happens)
{
  const auto end = std::chrono::steady_clock::now() + PATIENCE;
  do {
    for (int n = 0; n < 64; ++n) {
      if (happens()) return true;
      pause_processor();
    }
  } while (std::chrono::steady_clock::now() < end);
  return false;
}

// Returns when a condition is true; another thread is about to make it so.
template <class Happens> void wait_until(const Happens &happens)
{
  if (happens()) return;
  while (!wait_for(happens)) sched_yield();
}

}    // namespace mdanim
