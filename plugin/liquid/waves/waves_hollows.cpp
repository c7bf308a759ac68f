// SPDX-License-Identifier: GPL-2.0-only
// Spans that are dry inside at the start: hulls that float with their rims above the liquid.

#include "liquid/waves/columns.h"
#include "liquid/waves/waves.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

namespace {

// Whether a span stands on a floating body, and below a height is open only to floating bodies and other spans.
bool is_enclosed(const SolidParts &solid, const Span &span, double level, const std::function<bool(int, int)> &floats)
{
  if (span.low == 0 || !floats(span.column, span.low - 1)) return false;
  const int top = std::min(span.high, static_cast<int>(std::ceil(level)));
  for (int side = 0; side < 4; ++side) {
    const int other = neighbour(span.column, side, solid.nx, solid.ny);
    if (other < 0) return false;
    for (int z = span.low; z < top; ++z)
      if (solid.open_between(span.column, other, z) == 0 && !floats(other, z) && !floats(span.column, z)) return false;
  }
  return true;
}

}    // namespace

std::vector<std::uint8_t> Waves::hollows(double level, const std::function<bool(int column, int z)> &floats) const
{
  std::vector<std::uint8_t> hollow(content.size(), 0), seen(content.size(), 0);
  std::vector<long> body;
  each_span([&](long first) {
    if (seen[first] || span[first].floor >= level) return;
    bool enclosed = true;
    body.assign(1, first);
    seen[first] = 1;
    for (std::size_t n = 0; n < body.size(); ++n) {
      enclosed = enclosed && is_enclosed(solid, span[body[n]], level, floats);
      each_link_of(body[n], [&](const LinkPlace &link, long other, bool) {
        if (!is_link(link) || arrays_of(link).edge[link.at] >= level || seen[other]) return;
        seen[other] = 1;
        body.push_back(other);
      });
    }
    for (const long i : body) hollow[i] = enclosed;
  });
  return hollow;
}

}    // namespace mdanim
