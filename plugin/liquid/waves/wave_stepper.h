// SPDX-License-Identifier: GPL-2.0-only
// One update of the waves, step by step, (W1) to (W9): rows by the kernels, then listed spans and links by the general form.

#pragma once

#include "liquid/waves/wave_loops.h"
#include "liquid/waves/wave_mouths.h"
#include "liquid/waves/wave_solver.h"
#include "liquid/waves/wave_walls.h"

namespace mdanim {

class WaveStepper {
 public:
  // All must outlive this.
  WaveStepper(WaveColumns &columns, WaveRun &run, const WaveWalls &walls, WaveMouths &mouths)
      : columns(columns), run(run), walls(walls), mouths(mouths), law(run.law), arrays(columns.arrays), span(columns.span),
        content(columns.content), loops(columns, run.threads), solver(columns, run, mouths)
  {
  }

  // As Waves::update().
  double update(double dt, double share);
  // Whether liquid is slow enough to come to rest.
  bool hardly_flows() const;

 private:
  using LinkPlace = WaveColumns::LinkPlace;
  using Ends = WaveColumns::Ends;
  // All links on one side of a span together.
  struct SideLinks {
    double q, u, height;
    long widest;    // the span at the other end of the widest link, or -1
  };

  double fastest() const;
  void sub_update(double dt, double share);
  void find_surfaces();
  void move_links();
  Vec3 momentum(double *WaveLinks::*of_rows, double *WaveLinks::*of_links) const;
  void leave_behind();
  WaveLoops::RowRange balance();
  void limit(const WaveLoops::RowRange &tight);
  void general_surface(long i);
  void general_opening(const LinkPlace &link);
  void general_advection(const LinkPlace &link);
  void general_push(const LinkPlace &link);
  SpanFluxes<double> fluxes_of(long i) const;
  double most_in(long i) const { return (arrays.capacity[i] + 0.25) * law.units_per_cell; }
  SideLinks side_of(long i, SideOf side) const;

  WaveColumns &columns;
  WaveRun &run;
  const WaveWalls &walls;
  WaveMouths &mouths;
  WaveLaw &law;
  WaveArrays &arrays;
  const std::vector<Span> &span;
  const std::vector<Units> &content;
  WaveLoops loops;
  WaveSolver solver;
};

}    // namespace mdanim
