// SPDX-License-Identifier: GPL-2.0-only
// The columns of a basin with waves: spans, links between them, and where all of it lies in arrays.

#pragma once

#include "liquid/waves/columns.h"
#include "liquid/waves/span.h"
#include "liquid/waves/waves_kernels.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mdanim {

// Spans have places in arrays: the lowest span of a column has a place in the grid, further ones come in rows behind it. A link
// of lowest spans has the place of its first span; further links come behind. What is regular, one plain span in each column
// around, is left to vector kernels. All else is computed once more in a general form, from the same laws.
class WaveColumns {
 public:
  // Place of a link among those of its direction.
  struct LinkPlace {
    int d;
    long at;
  };
  struct Ends {
    long a, b;
  };
  // A further link of a span, and the next one in its chain.
  struct LinkOfSpan {
    LinkPlace link;
    bool inward;    // whether flux along the link comes in
    long other;
    int next;
  };
  // The part of a span that lasts from update to update.
  struct SpanState {
    Span span;
    Units content;
    double level;    // of its surface
    double full, rest, phi, delta, last_delta, coming;
  };
  static constexpr SpanState NO_SPAN{{-1, 0, 0, 0, true, 0.0, 0.0, 0}, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  struct LinkState {
    int column;    // of the first span
    long a, b;
    bool layered;
    double edge, top, u, q;
  };

  // Throws std::bad_alloc. No column has a span yet.
  WaveColumns(int nx, int ny, int nz);
  WaveColumns(const WaveColumns &) = delete;    // arrays point into vectors
  WaveColumns &operator=(const WaveColumns &) = delete;

  // --- where things are ---
  long place(int column) const { return (1 + column / nx) * stride + column % nx; }
  long place(int column, int n) const { return n == 0 ? place(column) : further_start + further[column] + n - 1; }
  long along(int d) const { return d == 0 ? 1 : stride; }
  long end_row() const { return 1 + ny + further_rows; }
  bool is_link(const LinkPlace &link) const { return arrays.links[link.d].edge[link.at] < WaveArrays::NOWHERE; }
  bool is_layered(const LinkPlace &link) const
  { return link.at < links_start ? layered[link.d][link.at] != 0 : further_links[link.d][link.at - links_start].layered; }
  Ends ends(const LinkPlace &link) const
  {
    if (link.at < links_start) return {link.at, link.at + along(link.d)};
    const LinkState &further_link = further_links[link.d][link.at - links_start];
    return {further_link.a, further_link.b};
  }
  const WaveLinks &arrays_of(const LinkPlace &link) const { return arrays.links[link.d]; }
  // Calls f(place) for all spans, f(link) for all links, in their order outside; and f(link, other span, inward) for those of a
  // span, in the order in which they are summed.
  template <class F> void each_span(const F &f) const { spans_of_columns(0, nx * ny, f); }
  template <class F> void each_link(const F &f) const
  {
    for (int d = 0; d < 2; ++d) {
      links_of_grid(d, stride, further_start, f);
      further_links_of(d, f);
    }
  }
  int row_of(long i) const { return span[i].column / nx; }
  template <class F> void spans_of_columns(long from, long to, const F &f) const
  {
    for (int column = static_cast<int>(from); column < to; ++column)
      for (int n = 0; n < spans_in[column]; ++n) f(place(column, n));
  }
  template <class F> void links_of_grid(int d, long from, long to, const F &f) const
  {
    for (long i = from; i < to; ++i)
      if (is_link({d, i})) f(LinkPlace{d, i});
  }
  template <class F> void further_links_of(int d, const F &f) const
  {
    for (std::size_t n = 0; n < further_links[d].size(); ++n) f(LinkPlace{d, links_start + static_cast<long>(n)});
  }
  template <class F> void each_link_of(long i, const F &f) const
  {
    f(LinkPlace{1, i - stride}, i - stride, true);
    f(LinkPlace{0, i - 1}, i - 1, true);
    f(LinkPlace{0, i}, i + 1, false);
    f(LinkPlace{1, i}, i + stride, false);
    each_further_link_of(i, f);
  }
  template <class F> void each_further_link_of(long i, const F &f) const
  {
    for (int n = chain[i]; n >= 0; n = link_of_span[n].next)
      f(link_of_span[n].link, link_of_span[n].other, link_of_span[n].inward);
  }

  double opening(const LinkPlace &link, double level) const;    // of a link up to a level
  // Inertia of a link over that of all that it moves.
  double ease(const LinkPlace &link) const { return 1.0 / (1.0 + arrays_of(link).more[link.at]); }

  // --- for new solids ---

  // Makes room for `rows` rows of further spans and for further links of each direction. The grid stays.
  void lay_out(long rows, std::size_t most_further_links);
  SpanState state_at(long i) const;
  void put(long i, const SpanState &state);
  // Links of the grid keep their places; further ones hold their velocities while places change.
  void save_further_links();
  // Joins all links at these columns and at those with several spans.
  void join(const std::vector<int> &columns);
  // Lists spans and links for the general form: those of irregular columns, and links that have such a column beside them.
  void list_irregular();

  const int nx, ny, nz;
  const long stride;
  const long further_start;    // place of the first further span
  long links_start = 0;        // place of the first further link
  long further_rows = 0;
  SolidParts solid, wall;               // all solids; the held ones
  bool all_general = false;             // for tests: the general form computes all spans and links
  std::vector<std::uint8_t> general;    // columns that are left to it although they are plain

  std::vector<int> spans_in, further;    // of each column: the number of spans, and the number of its first further one
  std::vector<Span> span;                // of each place; column -1 where there is none
  std::vector<Units> content;
  WaveArrays arrays;

  // Spans and links that the general form computes once more.
  std::vector<long> listed_spans, branched;
  std::vector<long> branched_rows;
  std::vector<LinkPlace> listed_links;

 private:
  void join_face(int d, int column, int other, const std::vector<LinkState> &was);
  void put_link(const LinkPlace &link, const LinkState &state);
  bool is_regular(int column) const;

  std::vector<std::vector<double>> of_spans, of_links[2];    // behind `arrays`
  std::vector<std::uint8_t> layered[2];                      // links of the grid that go through partly solid cells
  std::vector<LinkState> further_links[2];                   // their places come behind those of the grid
  std::vector<int> chain;                                    // first further link of each place in `link_of_span`, or -1
  std::vector<LinkOfSpan> link_of_span;
};

}    // namespace mdanim
