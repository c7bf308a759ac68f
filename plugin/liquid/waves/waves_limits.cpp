// SPDX-License-Identifier: GPL-2.0-only
// (W9): fluxes are scaled down, in whole units, where a span would give more than it has or take more than it can hold.

#include "liquid/waves/waves.h"

#include <algorithm>

namespace mdanim {

// Sums the units into spans and out of them. Returns the rows from the first to the last in which some span must be limited.
Waves::RowRange Waves::balance()
{
  std::atomic<int> first{ny}, last{0};
  const auto widen = [&](int row) {
    for (int known = first; row < known && !first.compare_exchange_weak(known, row);) {}
    for (int known = last; row + 1 > known && !last.compare_exchange_weak(known, row + 1);) {}
  };
  rows([&](long from, long to) {
    for (long row = from; row < to; ++row)
      if (!kernels->balance(arrays, law, row, row + 1) && row <= ny) widen(static_cast<int>(row) - 1);
  });
  each_listed(listed_spans, [&](long i) {    // including further spans, which lie in the rows after that
    const SpanFluxes<double> fluxes = fluxes_of(i);
    arrays.net[i] = fluxes.in - fluxes.out;
    if (fluxes.out_share(static_cast<double>(content[i])) != 1.0 ||
        fluxes.in_share(static_cast<double>(content[i]), most_in(i)) != 1.0)
      widen(row_of(i));
  });
  return {first, last};
}

// A flux scaled down in one row changes the rows beside it, so each time one row more is affected.
void Waves::limit(const RowRange &tight)
{
  constexpr int SCALED = 3;    // repetitions
  ++counts.limited;
  const RowRange near = {std::max(0, tight.first - SCALED), std::min(ny, tight.last + SCALED)};
  double *share = arrays.net;    // of a span, for the leaving or for the entering flux
  const auto scale = [&](bool by_giver) {
    each_link_in(near, [&](const LinkPlace &link) {
      const WaveLinks &l = arrays_of(link);
      const Ends e = ends(link);
      double &units = l.units[link.at];
      if (units == 0.0) return;
      const double part = share[(units > 0.0) == by_giver ? e.a : e.b];
      units = scaled_down(units, part);
      if (!by_giver) l.u[link.at] *= part;
    });
  };
  each_span_in(near, [&](long i) { share[i] = fluxes_of(i).out_share(static_cast<double>(content[i])); });
  scale(true);
  for (int pass = 0; pass < 2; ++pass) {    // units that a span gives less in the first pass are missing as room in the second
    std::atomic<bool> fits{true};
    each_span_in(near, [&](long i) {
      share[i] = fluxes_of(i).in_share(static_cast<double>(content[i]), most_in(i));
      if (share[i] != 1.0) fits.store(false, std::memory_order_relaxed);
    });
    if (fits) return;
    scale(false);
  }
}

}    // namespace mdanim
