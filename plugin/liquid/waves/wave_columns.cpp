// SPDX-License-Identifier: GPL-2.0-only
// Arrays of spans and links.

#include "liquid/waves/wave_columns.h"

#include <algorithm>
#include <iterator>

namespace mdanim {

namespace {

double *WaveArrays::*const OF_SPANS[] = {
    &WaveArrays::capacity, &WaveArrays::floor,  &WaveArrays::roof,        &WaveArrays::full,  &WaveArrays::rest,
    &WaveArrays::phi,      &WaveArrays::volume, &WaveArrays::head,        &WaveArrays::slope, &WaveArrays::yields,
    &WaveArrays::coming,   &WaveArrays::rhs,    &WaveArrays::beside_full, &WaveArrays::delta, &WaveArrays::last_delta,
    &WaveArrays::scale,    &WaveArrays::x,      &WaveArrays::r,           &WaveArrays::p,     &WaveArrays::flat,
    &WaveArrays::ap,       &WaveArrays::net,    &WaveArrays::sums,
};

double *WaveLinks::*const OF_LINKS[] = {
    &WaveLinks::edge,   &WaveLinks::top,    &WaveLinks::u,       &WaveLinks::q,      &WaveLinks::wet,
    &WaveLinks::height, &WaveLinks::faster, &WaveLinks::units,   &WaveLinks::rubbed, &WaveLinks::couple,
    &WaveLinks::more,   &WaveLinks::moving, &WaveLinks::rubbing,
};

}    // namespace

WaveColumns::WaveColumns(int nx, int ny, int nz)
    : nx(nx), ny(ny), nz(nz), stride((nx / WaveKernels::SUMMED + 1) * WaveKernels::SUMMED), further_start((1 + ny) * stride),
      solid(nx, ny, nz), wall(nx, ny, nz), general(nx * ny, 0), spans_in(nx * ny, 0), further(nx * ny, 0),
      of_spans(std::size(OF_SPANS))
{
  for (auto &arrays_of_links : of_links) arrays_of_links.resize(std::size(OF_LINKS));
  arrays.stride = stride;
  lay_out(0, 0);
}

void WaveColumns::lay_out(long rows, std::size_t most_further_links)
{
  further_rows = rows;
  const std::size_t n = (2 + ny + rows) * stride, old = content.size();
  if (n > old) {
    span.resize(n, Span{-1, 0, 0, 0, true, 0.0, 0.0, 0});
    content.resize(n, 0);
    chain.resize(n, -1);
    for (std::size_t k = 0; k < std::size(OF_SPANS); ++k) {
      of_spans[k].resize(n, OF_SPANS[k] == &WaveArrays::capacity ? WaveArrays::NOWHERE : 0.0);
      arrays.*OF_SPANS[k] = of_spans[k].data();
    }
    arrays.content = content.data();
  }
  links_start = static_cast<long>(content.size());
  for (int d = 0; d < 2; ++d) {
    layered[d].resize(content.size(), 0);
    const std::size_t room = content.size() + most_further_links;
    for (std::size_t k = 0; k < std::size(OF_LINKS); ++k) {
      const bool height = OF_LINKS[k] == &WaveLinks::edge || OF_LINKS[k] == &WaveLinks::top;
      if (n > old) of_links[d][k].resize(old);    // where further links were, spans of new rows come
      if (room > of_links[d][k].size()) of_links[d][k].resize(room, height ? WaveArrays::NOWHERE : 0.0);
      arrays.links[d].*OF_LINKS[k] = of_links[d][k].data();
    }
  }
}

WaveColumns::SpanState WaveColumns::state_at(long i) const
{
  const double level = arrays.full[i] > 0.0 ? span[i].roof : head_of(solid, span[i], content[i]).height;
  return {span[i],         content[i],           level,           arrays.full[i], arrays.rest[i], arrays.phi[i],
          arrays.delta[i], arrays.last_delta[i], arrays.coming[i]};
}

void WaveColumns::put(long i, const SpanState &state)
{
  span[i] = state.span;
  content[i] = state.content;
  arrays.capacity[i] = state.span.column < 0 ? WaveArrays::NOWHERE : static_cast<double>(state.span.capacity) / UNITS_PER_CELL;
  arrays.floor[i] = state.span.floor;
  arrays.roof[i] = state.span.roof;
  arrays.full[i] = state.full;
  arrays.rest[i] = state.rest;
  arrays.phi[i] = state.phi;
  arrays.delta[i] = state.delta;
  arrays.last_delta[i] = state.last_delta;
  arrays.coming[i] = state.coming;
}

double WaveColumns::opening(const LinkPlace &link, double level) const
{
  const WaveLinks &l = arrays_of(link);
  if (!is_layered(link)) return std::min(l.top[link.at], level) - l.edge[link.at];
  const Ends e = ends(link);
  return open_below(solid, span[e.a], span[e.b], level);
}

}    // namespace mdanim
