// SPDX-License-Identifier: GPL-2.0-only
// Arrays, and functions that are called from outside.

#include "liquid/waves/waves.h"

#include "simd/kernels.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace mdanim {

namespace {

double *WaveArrays::*const OF_SPANS[] = {
    &WaveArrays::capacity, &WaveArrays::floor,  &WaveArrays::roof,        &WaveArrays::full,  &WaveArrays::rest,
    &WaveArrays::phi,      &WaveArrays::volume, &WaveArrays::head,        &WaveArrays::slope, &WaveArrays::yields,
    &WaveArrays::coming,   &WaveArrays::rhs,    &WaveArrays::beside_full, &WaveArrays::delta, &WaveArrays::last_delta,
    &WaveArrays::scale,    &WaveArrays::x,      &WaveArrays::r,           &WaveArrays::p,     &WaveArrays::next_p,
    &WaveArrays::ap,       &WaveArrays::net,    &WaveArrays::sums,
};

double *WaveLinks::*const OF_LINKS[] = {
    &WaveLinks::edge,   &WaveLinks::top,    &WaveLinks::u,     &WaveLinks::q,      &WaveLinks::wet,
    &WaveLinks::height, &WaveLinks::faster, &WaveLinks::units, &WaveLinks::couple, &WaveLinks::moving,
};

}    // namespace

Waves::Waves(int nx, int ny, int nz)
    : nx(nx), ny(ny), nz(nz), stride((nx / WaveKernels::SUMMED + 1) * WaveKernels::SUMMED), further_start((1 + ny) * stride),
      solid(nx, ny, nz), wall(nx, ny, nz), walled_anew(nx * ny, 0), kernels(&widest_kernels().waves), spans_in(nx * ny, 0),
      further(nx * ny, 0), of_spans(std::size(OF_SPANS))
{
  law.height = nz;
  law.fastest = 4.0 * std::sqrt(law.height);
  for (auto &arrays_of_links : of_links) arrays_of_links.resize(std::size(OF_LINKS));
  arrays.stride = stride;
  lay_out(0, 0);
  std::vector<int> all(nx * ny);
  for (int column = 0; column < nx * ny; ++column) all[column] = column;
  carry_over(all, all, {});
  join(all);
  list_wall_faces();
}

// Makes room for `rows` rows of further spans and for further links of each direction. The grid stays.
void Waves::lay_out(long rows, std::size_t most_further_links)
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

void Waves::use_general_form()
{
  all_general = true;
  list_irregular();
}

void Waves::pour(const double *height, const double *from, const std::vector<std::uint8_t> &hollow)
{
  resting = false;
  each_span([&](long i) {
    const double level = !hollow.empty() && hollow[i] ? 0.0 : height[span[i].column];
    const auto up_to = [&](double z) {    // not a unit less than its capacity
      return z >= span[i].roof ? span[i].capacity : static_cast<Units>(volume_below(solid, span[i], z) * UNITS_PER_CELL);
    };
    content[i] = up_to(level) - (from ? up_to(std::min(level, from[span[i].column])) : 0);
    const Head head = head_of(solid, span[i], content[i]);
    const bool full = content[i] >= span[i].capacity;
    arrays.full[i] = full ? 1.0 : 0.0;
    arrays.rest[i] = arrays.phi[i] = arrays.head[i] = full ? std::max(span[i].roof, level) : head.height;
    arrays.delta[i] = arrays.last_delta[i] = 0.0;
  });
}

void Waves::set_velocities(const double *u)
{
  resting = false;
  each_link([&](const LinkPlace &link) {
    const Ends e = ends(link);
    const long upwind = *u > 0.0 ? e.a : e.b;
    const double level = std::max(head_of(solid, span[upwind], content[upwind]).height, arrays_of(link).edge[link.at]);
    arrays_of(link).u[link.at] = *u;
    arrays_of(link).q[link.at] = *u * opening(link, level);
    ++u;
  });
}

std::vector<Waves::SpanNow> Waves::spans() const
{
  std::vector<SpanNow> now;
  each_span([&](long i) {
    const bool full = arrays.full[i] > 0.0;
    const double head = full ? arrays.rest[i] : head_of(solid, span[i], content[i]).height;
    now.push_back({span[i], content[i], head, arrays.phi[i], full});
  });
  return now;
}

std::vector<Waves::LinkNow> Waves::links() const
{
  std::vector<int> number(content.size(), -1);
  int next = 0;
  each_span([&](long i) { number[i] = next++; });
  std::vector<LinkNow> now;
  each_link([&](const LinkPlace &link) {
    const WaveLinks &l = arrays_of(link);
    const Ends e = ends(link);
    now.push_back({number[e.a], number[e.b], link.d, l.u[link.at], l.height[link.at], static_cast<Units>(l.units[link.at])});
  });
  return now;
}

void Waves::surface(double *head, double *volume) const
{
  for (int column = 0; column < nx * ny; ++column) {
    head[column] = volume[column] = 0.0;
    for (int n = 0; n < spans_in[column]; ++n) {
      const long i = place(column, n);
      volume[column] += static_cast<double>(content[i]) / UNITS_PER_CELL;
      if (n > 0 && content[i] == 0) continue;
      head[column] = arrays.full[i] > 0.0 ? arrays.phi[i] : head_of(solid, span[i], content[i]).height;
    }
  }
}

Units Waves::total() const
{
  Units sum = 0;
  for (const Units units : content) sum += units;
  return sum;
}

Waves::Energy Waves::energy() const
{
  Energy energy{};
  each_span([&](long i) {
    const double volume = static_cast<double>(content[i]) / UNITS_PER_CELL, capacity = arrays.capacity[i];
    const double middle = 0.5 * (span[i].floor + head_of(solid, span[i], content[i]).height);
    energy.height += std::min(volume, capacity) * middle + std::max(0.0, volume - capacity) * span[i].roof;
  });
  each_link([&](const LinkPlace &link) {
    const WaveLinks &l = arrays_of(link);
    energy.motion += 0.5 * l.height[link.at] * l.u[link.at] * l.u[link.at];
  });
  return energy;
}

Vec3 Waves::momentum() const
{
  Vec3 sum;
  each_link([&](const LinkPlace &link) {
    const WaveLinks &l = arrays_of(link);
    (link.d == 0 ? sum.x : sum.y) += l.height[link.at] * l.u[link.at];
  });
  return sum;
}

}    // namespace mdanim
