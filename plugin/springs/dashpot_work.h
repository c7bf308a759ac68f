// SPDX-License-Identifier: GPL-2.0-only
// Work of dashpots in a step, spring by spring: the terms from which passes/loss.h sums the energy that they take.

#pragma once

#include "numbers/vec3.h"

namespace mdanim {

// F is the force of dashpots on each particle, dv^n = v^{n+1/2} - v^{n-1/2}; the signs are those of what is taken.
template <class Real> struct DashpotWork {
  Real work;    // -F^n . v^{n-1/2} - F^{n-1} . v^{n-1/2}
  Real bend;    // -(F^n - F^{n-1}) . dv^{n-1}
};

// The terms of one spring with c = 1 between steps n-1 and n. `rate` and `before` are its strain rates in the forces of these
// steps: (v_ij . r_ij) / r^2 of v^{n-1/2}, r^n and of v^{n-3/2}, r^{n-1}. The other numbers belong to v^{n-1/2} and r^n: v_ij .
// r_ij, r^2 and v_ij^2. As r^{n-1} was r^n - dt v_ij, `work` is exact. `bend` is c (n . dv_ij)^2 but for how far the spring turns
// and strains in a step, relative to how far its vibrations go: it corrects the sum by (omega dt)^2 at most.
template <class Real>
MDANIM_ALWAYS_INLINE DashpotWork<Real> dashpot_work(const Real &along, const Real &square, const Real &fast, const Real &rate,
                                                    const Real &before, double dt)
{
  const Real more = rate - before;
  return {rate * along + before * (along - dt * fast), more * more * square};
}

}    // namespace mdanim
