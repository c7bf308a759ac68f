// SPDX-License-Identifier: GPL-2.0-only
// Links between spans of neighbouring columns, and the list of those that are not regular.

#include "liquid/waves/wave_columns.h"

#include <algorithm>

namespace mdanim {

namespace {

constexpr double LEAST_OPENING = 1e-3;

// Where a link is open: from its edge to its top, in layers where a span is partly solid inside.
struct Gap {
  bool open, layered;
  double edge, top;
};

Gap gap_between(const SolidParts &solid, const Span &a, const Span &b)
{
  Gap gap{false, !a.plain || !b.plain, std::max(a.floor, b.floor), std::min(a.roof, b.roof)};
  if (!a.overlaps(b) || are_parted(solid, a, b)) return gap;
  if (!gap.layered) {
    gap.open = gap.top - gap.edge >= LEAST_OPENING;
    return gap;
  }
  for (int z = std::max(a.low, b.low); z < std::min(a.high, b.high) && !gap.open; ++z) {
    gap.open = solid.open_between(a.column, b.column, z) > 0;
    gap.edge = std::max({static_cast<double>(z), a.floor, b.floor});
  }
  return gap;
}

}    // namespace

void WaveColumns::save_further_links()
{
  for (int d = 0; d < 2; ++d)
    for (std::size_t n = 0; n < further_links[d].size(); ++n) {
      further_links[d][n].u = arrays.links[d].u[links_start + n];
      further_links[d][n].q = arrays.links[d].q[links_start + n];
    }
}

void WaveColumns::join(const std::vector<int> &columns)
{
  std::vector<std::uint8_t> wanted[2];    // faces, by the column in front of them
  for (auto &of_direction : wanted) of_direction.assign(nx * ny, 0);
  const auto want = [&](int column) {
    if (column % nx > 0) wanted[0][column - 1] = 1;
    if (column % nx < nx - 1) wanted[0][column] = 1;
    if (column >= nx) wanted[1][column - nx] = 1;
    if (column < nx * (ny - 1)) wanted[1][column] = 1;
  };
  for (const int column : columns) want(column);
  for (int column = 0; column < nx * ny; ++column)
    if (spans_in[column] > 1) want(column);

  for (int d = 0; d < 2; ++d) {
    std::vector<LinkState> was, at_face;
    was.swap(further_links[d]);
    std::size_t next = 0;
    for (int column = 0; column < nx * ny; ++column) {
      if (!wanted[d][column]) continue;
      at_face.clear();
      const long i = place(column);
      const WaveLinks &l = arrays.links[d];
      if (is_link({d, i})) at_face.push_back({column, 0, 0, false, l.edge[i], l.top[i], l.u[i], l.q[i]});
      for (; next < was.size() && was[next].column == column; ++next) at_face.push_back(was[next]);
      join_face(d, column, d == 0 ? column + 1 : column + nx, at_face);
    }
  }
  lay_out(further_rows, std::max(further_links[0].size(), further_links[1].size()));
  for (int d = 0; d < 2; ++d)
    for (std::size_t n = 0; n < further_links[d].size(); ++n)
      put_link({d, links_start + static_cast<long>(n)}, further_links[d][n]);
  list_irregular();
}

// Makes links anew where two columns meet: velocities of former links are carried over by their overlap.
void WaveColumns::join_face(int d, int column, int other, const std::vector<LinkState> &was)
{
  LinkState lowest{column, 0, 0, false, WaveArrays::NOWHERE, WaveArrays::NOWHERE, 0.0, 0.0};
  for (int m = 0; m < spans_in[column]; ++m)
    for (int n = 0; n < spans_in[other]; ++n) {
      const long a = place(column, m), b = place(other, n);
      const Gap gap = gap_between(solid, span[a], span[b]);
      if (!gap.open) continue;
      LinkState link{column, a, b, gap.layered, gap.edge, gap.top, 0.0, 0.0};
      double weight = 0.0, sum = 0.0, only = 0.0;
      int found = 0;
      for (const LinkState &old : was) {
        const double common = std::min(link.top, old.top) - std::max(link.edge, old.edge);
        if (common <= 0.0) continue;
        ++found;
        only = old.u;
        weight += common;
        sum += common * old.u;
        link.q += old.q * std::min(1.0, common / (old.top - old.edge));
      }
      if (found > 0) link.u = found == 1 ? only : sum / weight;
      if (m == 0 && n == 0)
        lowest = link;
      else
        further_links[d].push_back(link);
    }
  layered[d][place(column)] = lowest.layered;
  put_link({d, place(column)}, lowest);
}

void WaveColumns::put_link(const LinkPlace &link, const LinkState &state)
{
  const WaveLinks &l = arrays_of(link);
  l.edge[link.at] = state.edge;
  l.top[link.at] = state.top;
  l.u[link.at] = state.u;
  l.q[link.at] = state.q;
  l.wet[link.at] = l.height[link.at] = l.faster[link.at] = l.units[link.at] = l.couple[link.at] = l.more[link.at] = 0.0;
}

// A column is regular without spans, or with one that is plain and linked to all columns around that have spans.
bool WaveColumns::is_regular(int column) const
{
  if (spans_in[column] == 0) return true;
  if (spans_in[column] > 1 || general[column] || !span[place(column)].plain) return false;
  bool linked = true;
  const long i = place(column);
  const auto look = [&](const LinkPlace &link, long other) { linked = linked && (is_link(link) || span[other].column < 0); };
  look({0, i - 1}, i - 1);
  look({0, i}, i + 1);
  look({1, i - stride}, i - stride);
  look({1, i}, i + stride);
  return linked;
}

void WaveColumns::list_irregular()
{
  std::fill(chain.begin(), chain.end(), -1);
  link_of_span.clear();
  for (int d = 1; d >= 0; --d)
    for (long n = static_cast<long>(further_links[d].size()) - 1; n >= 0; --n) {    // chains are made from their ends
      const LinkState &link = further_links[d][n];
      for (const bool inward : {false, true}) {
        const long i = inward ? link.b : link.a;
        link_of_span.push_back({{d, links_start + n}, inward, inward ? link.a : link.b, chain[i]});
        chain[i] = static_cast<int>(link_of_span.size()) - 1;
      }
    }

  listed_spans.clear();
  listed_links.clear();
  std::vector<std::uint8_t> listed[2];    // links of the grid
  for (auto &of_direction : listed) of_direction.assign(content.size(), 0);
  branched.clear();
  branched_rows.clear();
  for (int column = 0; column < nx * ny; ++column) {
    const bool regular = !all_general && is_regular(column);
    for (int n = 0; n < spans_in[column]; ++n) {
      const long i = place(column, n);
      if (!regular || chain[i] >= 0) listed_spans.push_back(i);
      if (all_general || chain[i] >= 0) branched.push_back(i);
    }
    if (regular) continue;
    const long i = place(column);
    for (const long near : {i, i - 1, i + 1, i - stride, i + stride})
      for (const LinkPlace &link : {LinkPlace{0, near - 1}, {0, near}, {1, near - stride}, {1, near}})
        if (link.at >= 0) listed[link.d][link.at] = 1;
  }
  for (int d = 0; d < 2; ++d) {
    for (long i = stride; i < further_start; ++i)
      if (listed[d][i] && is_link({d, i})) listed_links.push_back({d, i});
    for (std::size_t n = 0; n < further_links[d].size(); ++n) listed_links.push_back({d, links_start + static_cast<long>(n)});
  }
  for (const long i : branched) branched_rows.push_back(i / stride);
  std::sort(branched_rows.begin(), branched_rows.end());
  branched_rows.erase(std::unique(branched_rows.begin(), branched_rows.end()), branched_rows.end());
}

}    // namespace mdanim
