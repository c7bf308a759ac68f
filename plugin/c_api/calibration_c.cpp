// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions on what this processor takes (passes/calibration.h), for ctypes. Numbers are nanoseconds: of each width
// without and with dashpots, in the order of mdanim_width_name, and last what a call of threads takes that sleep and that are
// awake.

#include "c_api/abi.h"
#include "c_api/guarded.h"
#include "passes/calibration.h"

#include <utility>

using namespace mdanim;

// The n-th width that runs here, the widest first; null beyond the last.
MDANIM_EXPORT const char *mdanim_width_name(int n) noexcept
{ return n < static_cast<int>(kernels_here().size()) ? kernels_here()[n]->name : nullptr; }

// Measures them. Returns 0, or 1 with a message in `error`.
MDANIM_EXPORT int mdanim_calibrate(double *ns, char *error, int error_size) noexcept
{
  return guarded(error, error_size, [&] {
    const Calibration found = measure_calibration();
    for (const Calibration::Width &width : found.widths) *ns++ = width.springs, *ns++ = width.dashpots;
    *ns++ = found.waking, *ns = found.calling;
  });
}

// From now on these are those of this process.
MDANIM_EXPORT int mdanim_give_calibration(const double *ns, char *error, int error_size) noexcept
{
  return guarded(error, error_size, [&] {
    Calibration known{};
    for (const Kernels *kernels : kernels_here()) {
      known.widths.push_back({kernels, ns[0], ns[1]});
      ns += 2;
    }
    known.waking = *ns++, known.calling = *ns;
    give_calibration(std::move(known));
  });
}
