// SPDX-License-Identifier: GPL-2.0-only
// The border to C: what is thrown inside becomes a return value and a message.

#ifndef MDANIM_GUARDED_H
#define MDANIM_GUARDED_H

#include <cstdio>
#include <exception>
#include <new>

namespace mdanim {

// Calls f. Returns 0, or 1 with the reason in `error`.
template <class F> int guarded(char *error, int error_size, F &&f)
{
  try {
    f();
    return 0;
  } catch (const std::bad_alloc &) {
    std::snprintf(error, error_size, "out of memory");
  } catch (const std::exception &problem) {
    std::snprintf(error, error_size, "%s", problem.what());
  } catch (...) {
    std::snprintf(error, error_size, "unknown error");
  }
  return 1;
}

}    // namespace mdanim

#endif
