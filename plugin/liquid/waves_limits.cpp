// SPDX-License-Identifier: GPL-2.0-only
// (W9): what passes is scaled down, in whole units, where a span would give more than it has or take more than it can hold.

#include "liquid/waves.h"

namespace mdanim {

void Waves::limit()
{
  ++counts.limited;
  double *share = arrays.net;    // of a span, of what leaves it or of what enters it
  const auto most = [&](long i) { return (arrays.capacity[i] + 0.25) * law.units_per_cell; };
  const auto scale = [&](bool by_giver) {
    each_link_shared([&](const LinkPlace &link) {
      const WaveLinks &l = arrays_of(link);
      const Ends e = ends(link);
      double &units = l.units[link.at];
      if (units == 0.0) return;
      const double part = share[(units > 0.0) == by_giver ? e.a : e.b];
      units = scaled_down(units, part);
      if (!by_giver) l.u[link.at] *= part;
    });
  };
  each_span_shared([&](long i) { share[i] = fluxes_of(i).out_share(static_cast<double>(content[i])); });
  scale(true);
  for (int pass = 0; pass < 2; ++pass) {    // what a span gives less in the first one is missing as room in the second
    std::atomic<bool> fits{true};
    each_span_shared([&](long i) {
      share[i] = fluxes_of(i).in_share(static_cast<double>(content[i]), most(i));
      if (share[i] != 1.0) fits.store(false, std::memory_order_relaxed);
    });
    if (fits) return;
    scale(false);
  }
}

}    // namespace mdanim
