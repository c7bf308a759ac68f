// SPDX-License-Identifier: GPL-2.0-only
// (W2) and (W8) for one link, or for one in each lane. The kernels and the general form differ only in the opening of a link up
// to a level.

#pragma once

#include "liquid/waves/waves_kernels.h"
#include "simd/vectors.h"

namespace mdanim {

// A link, and the spans that it joins.
struct LinkAt {
  const WaveLinks &links;
  int d;    // its direction
  long link, a, b;
};

template <class Real> struct Levels {
  Real edge, a, b;
};

// Heights to which a link is filled from its two sides.
template <class Real> MDANIM_ALWAYS_INLINE Levels<Real> levels_at(const WaveArrays &arrays, const WaveLaw &law, const LinkAt &at)
{
  const Real edge = load<Real>(at.links.edge + at.link);
  return {edge, level_at(law, load<Real>(arrays.head + at.a), load<Real>(arrays.volume + at.a), edge),
          level_at(law, load<Real>(arrays.head + at.b), load<Real>(arrays.volume + at.b), edge)};
}

template <class Real, class Opening>
MDANIM_ALWAYS_INLINE void open_at(const WaveArrays &arrays, const WaveLaw &law, const LinkAt &at, const Opening &opening)
{
  const WaveLinks &links = at.links;
  const long i = at.link;
  const auto level = levels_at<Real>(arrays, law, at);
  const auto opened = open_link(level.a, level.b, level.edge, load<Real>(links.u + i), load<Real>(links.q + i), opening);
  store(links.height + i, opened.height);
  store(links.wet + i, opened.wet);
  store(links.u + i, opened.u);
  store(links.q + i, opened.q);
}

template <class Real, class Opening>
MDANIM_ALWAYS_INLINE void push_at(const WaveArrays &arrays, const WaveLaw &law, const LinkAt &at, const Opening &opening,
                                  double ease = 1.0)
{
  const WaveLinks &links = at.links;
  const long i = at.link;
  const auto level = levels_at<Real>(arrays, law, at);
  const auto flow = pushed(law, load<Real>(links.faster + i), load<Real>(links.wet + i), load<Real>(arrays.phi + at.a),
                           load<Real>(arrays.phi + at.b), level.a, level.b, level.edge, law.tilt[at.d], ease, opening);
  store(links.u + i, flow.u);
  store(links.units + i, flow.units);
}

}    // namespace mdanim
