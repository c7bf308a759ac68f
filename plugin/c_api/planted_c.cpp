// SPDX-License-Identifier: GPL-2.0-only
// Two errors, planted to prove that a build with sanitizers reports errors (tests/sanitize.py). No other build has this file.

#include "c_api/abi.h"

#include <limits>
#include <memory>

// Reads beyond n numbers.
MDANIM_EXPORT int mdanim_plant_heap_overflow(int n)
{
  const std::unique_ptr<int[]> numbers(new int[n]());
  const volatile int *const all = numbers.get();
  return all[n];
}

// Adds n > 0 to the largest number.
MDANIM_EXPORT int mdanim_plant_signed_overflow(int n) { return std::numeric_limits<int>::max() + n; }
