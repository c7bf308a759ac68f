// SPDX-License-Identifier: GPL-2.0-only
// Access to the waves for tests.

#pragma once

#include "liquid/waves/waves.h"

namespace mdanim {

struct WavesProbe {
  struct SpanNow {
    Span span;
    Units content;
    double head, phi;    // head of the surface, and the head that pushes
    bool full;
  };
  struct LinkNow {
    int a, b, direction;    // numbers of spans; 0 along x, 1 along y
    double u, height;
    Units units;    // units that passed in the last sub-update
  };
  explicit WavesProbe(Waves &waves) : waves(waves), columns(waves.columns), arrays(columns.arrays) {}

  // Columns in their order, each from the lowest span up.
  std::vector<SpanNow> spans() const;
  // Links along x, then links along y, by the columns of their first spans.
  std::vector<LinkNow> links() const;
  // Head of the topmost wet span of each column (the floor of the lowest where all are dry), and the column's volume.
  void surface(double *head, double *volume) const;
  // Sets velocities of links, in the order of links(), also higher ones than liquid may have.
  void set_velocities(const double *u);
  void use_general_form();    // for all spans and links
  // Adds the forces on solids. `owner` is the body of each cell, or negative; `force` has three numbers for each body.
  void add_forces(const std::int32_t *owner, double *force) const;

 private:
  using LinkPlace = WaveColumns::LinkPlace;
  using Ends = WaveColumns::Ends;

  Waves &waves;
  WaveColumns &columns;
  WaveArrays &arrays;
};

}    // namespace mdanim
