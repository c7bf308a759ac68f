// SPDX-License-Identifier: GPL-2.0-only
// Bodies of liquid among solids: what comes to rest, and what is dry inside at the start.

#include "liquid/waves/columns.h"
#include "liquid/waves/wave_solids.h"

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

// Bodies are spans joined through links in which liquid stands on both sides. A thin layer joins nothing: it would drip for
// thousands of updates, or for ever where it passes no whole unit. So puddles, and pools held by a rim, stay as they are.
void WaveSolids::come_to_rest()
{
  constexpr double PUDDLE = 16.0;    // films
  std::vector<double> head(content.size(), 0.0);
  columns.each_span(
      [&](long i) { head[i] = arrays.full[i] > 0.0 ? arrays.phi[i] : head_of(columns.solid, span[i], content[i]).height; });
  std::vector<long> bodies;             // one after the other
  std::vector<std::size_t> first{0};    // of each body
  std::vector<std::uint8_t> found(content.size(), 0);
  bool level = true;
  columns.each_span([&](long start) {
    if (!level || found[start]) return;
    double low = head[start], high = head[start];
    found[start] = 1;
    bodies.push_back(start);
    for (std::size_t next = first.back(); next < bodies.size(); ++next) {
      const long i = bodies[next];
      low = std::min(low, head[i]);
      high = std::max(high, head[i]);
      columns.each_link_of(i, [&](const LinkPlace &link, long other, bool) {
        if (found[other] || !columns.is_link(link)) return;
        if (columns.opening(link, std::min(head[i], head[other])) <= PUDDLE * run.law.film) return;
        found[other] = 1;
        bodies.push_back(other);
      });
    }
    first.push_back(bodies.size());
    level = high - low < run.rest;
  });
  if (!level) return;

  for (std::size_t n = 0; n + 1 < first.size(); ++n) level_out({bodies.begin() + first[n], bodies.begin() + first[n + 1]});
  columns.each_link([&](const LinkPlace &link) {
    const WaveLinks &l = columns.arrays_of(link);
    l.u[link.at] = l.q[link.at] = l.units[link.at] = 0.0;
  });
  columns.each_span([&](long i) { arrays.delta[i] = arrays.last_delta[i] = arrays.coming[i] = 0.0; });
  run.resting = true;
}

// The highest level, in whole units, that the body's content reaches; the rest goes to the spans that the next unit of height
// would fill, one after the other.
void WaveSolids::level_out(const std::vector<long> &body)
{
  const auto held = [&](long i, Units level) {
    const double volume = volume_below(columns.solid, span[i], static_cast<double>(level) / UNITS_PER_CELL);
    return std::min(span[i].capacity, static_cast<Units>(volume * UNITS_PER_CELL));
  };
  const auto all_held = [&](Units level) {
    Units sum = 0;
    for (const long i : body) sum += held(i, level);
    return sum;
  };
  Units left = 0;
  for (const long i : body) left += content[i];
  Units low = 0, high = static_cast<Units>(columns.nz + 1) * UNITS_PER_CELL;    // held() of low is not too much, that of high is
  if (all_held(high) <= left) return;                                           // full throughout: no span has a surface
  while (high - low > 1) {
    const Units middle = low + (high - low) / 2;
    (all_held(middle) <= left ? low : high) = middle;
  }
  left -= all_held(low);
  const double level = static_cast<double>(low) / UNITS_PER_CELL;
  for (const long i : body) {
    content[i] = held(i, low);
    const Units more = std::min(left, held(i, low + 1) - content[i]);
    content[i] += more;
    left -= more;
    const bool full = content[i] >= span[i].capacity;
    arrays.full[i] = full ? 1.0 : 0.0;
    arrays.phi[i] = arrays.rest[i] = full ? std::max(level, span[i].roof) : level;
  }
}

std::vector<std::uint8_t> WaveSolids::hollows(double level, const std::function<bool(int column, int z)> &floats) const
{
  std::vector<std::uint8_t> hollow(content.size(), 0), seen(content.size(), 0);
  std::vector<long> body;
  columns.each_span([&](long first) {
    if (seen[first] || span[first].floor >= level) return;
    bool enclosed = true;
    body.assign(1, first);
    seen[first] = 1;
    for (std::size_t n = 0; n < body.size(); ++n) {
      enclosed = enclosed && is_enclosed(columns.solid, span[body[n]], level, floats);
      columns.each_link_of(body[n], [&](const LinkPlace &link, long other, bool) {
        if (!columns.is_link(link) || columns.arrays_of(link).edge[link.at] >= level || seen[other]) return;
        seen[other] = 1;
        body.push_back(other);
      });
    }
    for (const long i : body) hollow[i] = enclosed;
  });
  return hollow;
}

}    // namespace mdanim
