// SPDX-License-Identifier: GPL-2.0-only
// The topmost liquid of columns.

#include "liquid/waves/wave_heights.h"

#include "liquid/waves/columns.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mdanim {

static constexpr double PUDDLE = 1.0 / 64.0;    // in cells: lower floors belong to the floor of the basin, thinner layers are dry

void WaveHeights::find(const WaveExchange &waves, int nz, const std::vector<double> &moving)
{
  std::vector<int> unknown;
  for (int c = 0; c < nx * ny; ++c) {
    find_of(c, waves, nz, moving[c] == 0.0);
    if (std::isnan(heads[c])) unknown.push_back(c);
  }
  for (const int c : fill_inward(heads, unknown, nx, ny)) heads[c] = 0.0;    // solid from wall to wall
  for (const int c : unknown) {
    if (moving[c] != 0.0) continue;
    const WaveExchange::SpanView top = waves.span_view(c, waves.spans_of(c) - 1);
    if (top.high != nz || !(heads[c] > top.floor)) continue;
    heads[c] = top.floor;    // dry ground that is lower than the liquid around
    hollow[c] = 1;
  }
  above_all = std::clamp(static_cast<int>(std::ceil(*std::max_element(heads.begin(), heads.end()))), 0, nz);
  highest = 0.0;
  for (const double top : tops)
    if (top > highest) highest = top;
}

// Finds the head of the topmost liquid, NaN where there is none below a solid. Its top is given where there is no solid above it.
void WaveHeights::find_of(int column, const WaveExchange &waves, int nz, bool stands)
{
  const int spans = waves.spans_of(column);
  hollow[column] = 0;
  heads[column] = tops[column] = std::numeric_limits<double>::quiet_NaN();
  for (int n = spans - 1; n >= 0; --n) {
    const WaveExchange::SpanView span = waves.span_view(column, n);
    const bool last = n == spans - 1 && span.high == nz;
    // A thin layer on a body is not a surface, on ground it is; dry ground on the open floor is one.
    const bool on_floor = n == 0 && last && span.floor < PUDDLE;
    if (!on_floor && span.volume < (last && stands ? PUDDLE : ON_BODY)) continue;
    heads[column] = std::min(span.phi, nz + 1.0);
    if (last) tops[column] = std::min(span.surface, nz + 1.0);
    if (last) return;
    const WaveExchange::SpanView above = waves.span_view(column, spans - 1);
    hollow[column] = above.high == nz && heads[column] > above.floor + 1.0;
    return;
  }
}

}    // namespace mdanim
