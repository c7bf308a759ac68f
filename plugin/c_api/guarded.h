// SPDX-License-Identifier: GPL-2.0-only
// The border between C++ and ctypes: C cannot pass an exception on, so no exception leaves a function of c_api.

#pragma once

#include <cstdio>
#include <exception>
#include <new>

namespace mdanim {

// Calls work(). Returns 0, or 1 with the text of the exception that ended it in `error`, which has room for `error_size` bytes.
template <class Work> int guarded(char *error, int error_size, Work work) noexcept
{
  try {
    work();
    return 0;
  } catch (const std::bad_alloc &) {
    std::snprintf(error, error_size, "out of memory");
  } catch (const std::exception &e) {
    std::snprintf(error, error_size, "%s", e.what());
  } catch (...) {
    std::snprintf(error, error_size, "unknown error");
  }
  return 1;
}

// Returns the result of work(), or `failed` if an exception ends it: for functions without room for a message.
template <class Value, class Work> Value guarded(Value failed, Work work) noexcept
{
  try {
    return work();
  } catch (...) {
    return failed;
  }
}

}    // namespace mdanim
