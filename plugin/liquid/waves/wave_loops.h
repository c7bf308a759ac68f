// SPDX-License-Identifier: GPL-2.0-only
// Data that the parts of waves share, and loops over rows, spans and links that threads share.

#pragma once

#include "liquid/waves/wave_columns.h"
#include "numbers/vec3.h"
#include "threads/team.h"

#include <atomic>

namespace mdanim {

struct WaveRun {
  WaveLaw law;
  const WaveKernels *kernels = nullptr;
  Threads threads;
  double tolerance = 2e-3;    // of the solver
  int most_iterations = 200;
  double rest = 1.0 / 1024.0;    // differences of heads, and velocities, that count as none: those of a film

  bool resting = false;            // nothing will move before a solid does
  bool is_moved = false;           // the basin moves, and liquid never comes to rest
  bool some_full = false;          // some span is
  Vec3 lost, came, left_behind;    // momentum, see Waves::take_lost()
  double climbed = 0.0;            // see Waves::take_climbed()
  double brought = 0.0;            // see Waves::take_brought()
  struct Counts {                  // for tests and benchmarks
    long updates = 0, sub_updates = 0, solutions = 0, iterations = 0, limited = 0;
    Units displaced = 0;    // units displaced by spans that closed
  } counts;

  double limited(double u) const { return std::clamp(u, -law.fastest, law.fastest); }
};

class WaveLoops {
 public:
  // Rows of columns, from the first one to that before the last.
  struct RowRange {
    int first, last;
  };

  WaveLoops(const WaveColumns &columns, const Threads &threads) : columns(columns), threads(threads) {}

  // Calls f(first, end) for parts of all rows, shared among threads: no row writes where another reads or writes.
  template <class F> void rows(const F &f) const
  {
    constexpr double COLUMN = 2.0;    // [ns], approximately
    threads.parts(columns.end_row() - 1, COLUMN * static_cast<double>(columns.stride),
                  [&](long from, long to) { f(1 + from, 1 + to); });
  }
  // Whether f(first, end) is true for any part.
  template <class F> bool any_row(const F &f) const
  {
    std::atomic<bool> any{false};
    rows([&](long first, long end) {
      if (f(first, end)) any.store(true, std::memory_order_relaxed);
    });
    return any;
  }
  // The same for all spans and links that are listed; f(one) writes only into its own.
  template <class All, class F> void each_listed(const All &all, const F &f) const
  {
    constexpr double ONE = 50.0;    // [ns], approximately
    threads.parts(static_cast<long>(all.size()), ONE, [&](long from, long to) {
      for (long n = from; n < to; ++n) f(all[n]);
    });
  }
  // The same for spans in these rows and for links between two of them, in any order, shared among threads; f writes only into
  // the span or the link.
  template <class F> void each_span_in(const RowRange &rows, const F &f) const
  {
    constexpr double SPAN = 15.0;    // [ns], approximately
    const long before = static_cast<long>(rows.first) * columns.nx;
    threads.parts((rows.last - rows.first) * columns.nx, SPAN,
                  [&](long from, long to) { columns.spans_of_columns(before + from, before + to, f); });
  }
  template <class F> void each_link_in(const RowRange &rows, const F &f) const
  {
    constexpr double LINK = 5.0;    // [ns], approximately
    const auto within = [&](long i) { return columns.row_of(i) >= rows.first && columns.row_of(i) < rows.last; };
    for (int d = 0; d < 2; ++d) {
      const long before = (1 + rows.first) * columns.stride;
      threads.parts((rows.last - rows.first - d) * columns.stride, LINK,
                    [&](long from, long to) { columns.links_of_grid(d, before + from, before + to, f); });
      columns.further_links_of(d, [&](const LinkPlace &link) {
        if (within(columns.ends(link).a) && within(columns.ends(link).b)) f(link);
      });
    }
  }

 private:
  using LinkPlace = WaveColumns::LinkPlace;

  const WaveColumns &columns;
  const Threads &threads;
};

}    // namespace mdanim
