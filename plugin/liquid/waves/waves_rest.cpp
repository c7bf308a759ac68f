// SPDX-License-Identifier: GPL-2.0-only
// (W10): liquid that is nearly at rest comes to rest. Each body of it gets its level, to the unit, and nothing more is computed
// until a solid moves.

#include "liquid/waves/waves.h"

#include <algorithm>

namespace mdanim {

// Bodies are spans joined through links in which liquid stands on both sides. A thin layer joins nothing: it would drip for
// thousands of updates, or for ever where it passes no whole unit. So puddles, and pools held by a rim, stay as they are.
void Waves::come_to_rest()
{
  constexpr double PUDDLE = 16.0;    // films
  std::vector<double> head(content.size(), 0.0);
  each_span([&](long i) { head[i] = arrays.full[i] > 0.0 ? arrays.phi[i] : head_of(solid, span[i], content[i]).height; });
  std::vector<long> bodies;             // one after the other
  std::vector<std::size_t> first{0};    // of each body
  std::vector<std::uint8_t> found(content.size(), 0);
  bool level = true;
  each_span([&](long start) {
    if (!level || found[start]) return;
    double low = head[start], high = head[start];
    found[start] = 1;
    bodies.push_back(start);
    for (std::size_t next = first.back(); next < bodies.size(); ++next) {
      const long i = bodies[next];
      low = std::min(low, head[i]);
      high = std::max(high, head[i]);
      each_link_of(i, [&](const LinkPlace &link, long other, bool) {
        if (found[other] || !is_link(link)) return;
        if (opening(link, std::min(head[i], head[other])) <= PUDDLE * law.film) return;
        found[other] = 1;
        bodies.push_back(other);
      });
    }
    first.push_back(bodies.size());
    level = high - low < rest;
  });
  if (!level) return;

  for (std::size_t n = 0; n + 1 < first.size(); ++n) level_out({bodies.begin() + first[n], bodies.begin() + first[n + 1]});
  each_link([&](const LinkPlace &link) {
    const WaveLinks &l = arrays_of(link);
    l.u[link.at] = l.q[link.at] = l.units[link.at] = 0.0;
  });
  each_span([&](long i) { arrays.delta[i] = arrays.last_delta[i] = arrays.coming[i] = 0.0; });
  resting = true;
}

// The highest level, in whole units, that the body's content reaches; the rest goes to the spans that the next unit of height
// would fill, one after the other.
void Waves::level_out(const std::vector<long> &body)
{
  const auto held = [&](long i, Units level) {
    const double volume = volume_below(solid, span[i], static_cast<double>(level) / UNITS_PER_CELL);
    return std::min(span[i].capacity, static_cast<Units>(volume * UNITS_PER_CELL));
  };
  const auto all_held = [&](Units level) {
    Units sum = 0;
    for (const long i : body) sum += held(i, level);
    return sum;
  };
  Units left = 0;
  for (const long i : body) left += content[i];
  Units low = 0, high = static_cast<Units>(nz + 1) * UNITS_PER_CELL;    // held() of low is not too much, that of high is
  if (all_held(high) <= left) return;                                   // full throughout: no span has a surface
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

}    // namespace mdanim
