// SPDX-License-Identifier: GPL-2.0-only
// Work of the dashpots' force on a particle in a step: the terms from which passes/loss.h sums the energy that dashpots take.

#pragma once

#include "numbers/vec3.h"

namespace mdanim {

// F is the force of dashpots, dv^n = v^{n+1/2} - v^{n-1/2}.
template <class Real> struct DashpotWork {
  Real work;     // F^n . (v^{n-1/2} + v^{n+1/2})
  Real bend;     // F^n . dv^{n-1}
  Real ahead;    // F^{n-1} . dv^n
};

// `now` is F^n, `before` F^{n-1}, `seen` v^{n-3/2}; the step goes from v^{n-1/2} `first` to v^{n+1/2} `last`.
template <class Real>
MDANIM_ALWAYS_INLINE DashpotWork<Real> dashpot_work(const Vec<Real> &now, const Vec<Real> &before, const Vec<Real> &seen,
                                                    const Vec<Real> &first, const Vec<Real> &last)
{ return {dot(now, first + last), dot(now, first - seen), dot(before, last - first)}; }

}    // namespace mdanim
