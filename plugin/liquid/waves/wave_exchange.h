// SPDX-License-Identifier: GPL-2.0-only
// The liquid of columns for what comes and goes between updates, drops, inflows and drains, and for what floats in it. Links do
// not count what comes and goes, so the caller keeps the account.

#pragma once

#include "liquid/waves/wave_columns.h"
#include "liquid/waves/wave_loops.h"

#include <vector>

namespace mdanim {

class WaveExchange {
 public:
  // Both must outlive this.
  WaveExchange(WaveColumns &columns, WaveRun &run)
      : columns(columns), run(run), arrays(columns.arrays), span(columns.span), content(columns.content)
  {
  }

  // Puts units, with a velocity limited to that of liquid, into the span of a column that holds a height, or else into the next
  // one below. Returns the number of units that found room.
  Units give(int column, double height, Units units, double ux, double uy);
  // Takes units out of such a span; a film stays. Returns their number.
  Units take(int column, double height, Units most);
  double held_below(int column, double height) const;    // content of such a span below a height
  double head_below(int column, double height) const;    // head of its surface
  // The topmost span of a column: its floor, surface and volume, the speed at which the surface has just risen, the mean velocity
  // of the liquid, and the speed at which the liquid around could shoot up there (Bernoulli).
  struct Top {
    double floor, head, volume, rising, u[2], jet;
  };
  Top top_of(int column) const;

  // The n-th span of a column, from the lowest up.
  struct SpanView {
    int low, high;
    double floor, roof, phi, surface;    // phi: the head that pushes; surface: the visible one
    double volume, capacity;
    bool wet, full;
  };
  int spans_of(int column) const { return columns.spans_in[column]; }
  SpanView span_view(int column, int n) const;
  // West, east, south and north of a span, through its widest wet link: how much higher the head that pushes is there, and the
  // velocity; 0 where there is no link.
  struct Sides {
    double rise[4], u[4];
  };
  Sides around(int column, int n) const;
  // Adds momentum along x and y to the liquid of each column, in cells of liquid. Liquid at rest stays at rest if it is
  // negligible. Momentum beyond the greatest velocity is lost.
  void add_impulse(const double *x, const double *y);

 private:
  using LinkPlace = WaveColumns::LinkPlace;
  using Ends = WaveColumns::Ends;

  int span_below(int column, double height) const;
  Vec3 velocity_of(long i) const;
  double filled(const LinkPlace &link, double head, long other) const;

  WaveColumns &columns;
  WaveRun &run;
  WaveArrays &arrays;
  std::vector<Span> &span;
  std::vector<Units> &content;
};

}    // namespace mdanim
