// SPDX-License-Identifier: GPL-2.0-only
// Pockets by their links, each found by its first place.

#include "liquid/waves/wave_pockets.h"

#include <algorithm>

namespace mdanim {

void WavePockets::level()
{
  if (!find()) return;
  const WaveArrays &arrays = columns.arrays;
  const long places = static_cast<long>(before.size());
  sum.assign(places, 0.0);
  count.assign(places, 0);
  for (long i = 0; i < places; ++i)
    if (before[i] >= 0) {
      const long first = first_of(i);
      sum[first] += arrays.scale[i] * arrays.x[i];
      ++count[first];
    }
  for (long i = 0; i < places; ++i)
    if (before[i] >= 0 && !is_open[first_of(i)]) {
      const long first = first_of(i);
      arrays.x[i] -= sum[first] / (count[first] * arrays.scale[i]);
    }
}

bool WavePockets::find()
{
  const WaveArrays &arrays = columns.arrays;
  const long places = columns.end_row() * columns.stride;
  before.assign(places, -1);
  bool any = false;
  for (long i = 0; i < places; ++i)
    if (arrays.full[i] > 0.0 && arrays.yields[i] == 0.0) {
      before[i] = i;
      any = true;
    }
  if (!any) return false;
  is_open.assign(places, 0);
  columns.each_link([&](const WaveColumns::LinkPlace &link) {
    const WaveColumns::Ends ends = columns.ends(link);
    join(ends.a, ends.b, columns.arrays_of(link).couple[link.at]);
  });
  for (long i = 0; i < places; ++i)
    if (before[i] == i && !is_open[i]) return true;
  return false;
}

void WavePockets::join(long a, long b, double couple)
{
  if (!(couple > 0.0)) return;
  const bool has_a = before[a] >= 0, has_b = before[b] >= 0;
  if (has_a && has_b) {
    const long first = first_of(a), second = first_of(b);
    before[std::max(first, second)] = std::min(first, second);
    is_open[std::min(first, second)] |= is_open[std::max(first, second)];
  } else if (has_a || has_b) {
    is_open[first_of(has_a ? a : b)] = 1;
  }
}

long WavePockets::first_of(long i)
{
  while (before[i] != i) i = before[i] = before[before[i]];
  return i;
}

}    // namespace mdanim
