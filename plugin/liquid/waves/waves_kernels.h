// SPDX-License-Identifier: GPL-2.0-only
// The loops of an update of waves over whole rows of columns, once for each set of instructions (simd/kernels.h). All give the
// same bits: every lane computes the expressions of liquid/waves/law.h, and sums are taken by rows in eight parts.

#pragma once

#include "liquid/waves/law.h"

#include <cstdint>

namespace mdanim {

// Arrays of links of one direction, see WaveArrays.
struct WaveLinks {
  double *edge, *top, *u, *q;    // heights between which it is open; velocity, and the flux that made the present contents
  double *wet, *height, *faster, *units;    // see Opened; u after advection; units that pass
  double *rubbed;                           // velocity that the ground has taken; only with friction of the ground
  double *couple;
  double *more;                // inertia of the liquid that turns up or down at its mouth, over that of the link: mouth_inertia()
  double *moving, *rubbing;    // momentum before pressure, and what the ground has taken of it, of rows
};

// Arrays of spans and links, row after row. A row is `stride` long, a multiple of 8 that leaves at least one place behind the
// last column; there is an empty row before the first and after the last. Link i along x joins spans i and i + 1, along y spans i
// and i + stride. A place without a span has no liquid; a place without a link has its edge at NOWHERE.
struct WaveArrays {
  static constexpr double NOWHERE = 1e9;

  long stride;
  std::int64_t *content;
  double *capacity, *floor, *roof;    // of spans, in cells
  double *full, *rest, *phi;          // see SpanSurface
  double *volume, *head, *slope;
  double *yields, *coming;    // 1/mass of floating bodies above, 0 where they are held; change of the capacity, see (W6)
  double *rhs, *beside_full;
  double *delta, *last_delta;        // phi - head, in this update and in the last one
  double *scale, *x, *r, *p, *ap;    // of the solver
  double *flat;                      // x of a change of heads by 1; 0 where nothing is joined
  double *net;                       // units gained by a span
  double *sums;                      // of rows
  WaveLinks links[2];                // along x, along y
};

// The system of blocks, row after row of blocks from the first one: D, and the couplings to the next block along x and along y.
struct BlockSums {
  double *diagonal, *couple[2];
  long end_row;    // of columns
};

// Rows [first, end); the first row with columns is 1. No row writes where another reads or writes.
struct WaveKernels {
  static constexpr int SUMMED = 8;    // numbers of a row are summed in this number of parts
  static constexpr int BLOCK = 4;     // columns along the edge of a block

  bool (*surfaces)(const WaveArrays &, const WaveLaw &, long first, long end);             // (W1); whether some span is full
  void (*open_links)(const WaveArrays &, const WaveLaw &, int d, long first, long end);    // (W2) of direction d
  void (*advect)(const WaveArrays &, const WaveLaw &, int d, long first, long end);        // (W3), (W4)
  void (*assemble)(const WaveArrays &, const WaveLaw &, bool some_full, long first, long end);    // (W5), (W6)
  void (*couple)(const WaveArrays &, long first, long end);
  void (*guess)(const WaveArrays &, bool again, long first, long end);    // x; `again`: from delta
  void (*start)(const WaveArrays &, long first, long end);                // r = rhs - A x
  // x += alpha p, and then p = r + flat lift + beta p. Unless null, `lift` has a row for each row of blocks.
  void (*turn)(const WaveArrays &, double alpha, double beta, const double *lift, long first, long end);
  void (*product)(const WaveArrays &, long first, long end);                      // ap = A p
  void (*advance)(const WaveArrays &, double alpha, long first, long end);        // r -= alpha ap
  void (*finish)(const WaveArrays &, double alpha, long first, long end);         // x += alpha p
  void (*gather)(const WaveArrays &, double *to, long first, long end);           // flat r, summed in each row of each block
  void (*blocks)(const WaveArrays &, const BlockSums &, long first, long end);    // the system of rows of blocks
  void (*sum)(const WaveArrays &, const double *a, const double *b, long first, long end);    // of a b, to `sums`
  void (*heads)(const WaveArrays &, const WaveLaw &, long first, long end);          // (W7), and delta becomes the last one
  void (*push)(const WaveArrays &, const WaveLaw &, int d, long first, long end);    // (W8), and `moving`
  double (*fastest)(const WaveArrays &, long first, long end);                       // the largest |u|
  bool (*balance)(const WaveArrays &, const WaveLaw &, long first, long end);        // to `net`; whether (W9) holds
  void (*settle)(const WaveArrays &, const WaveLaw &, long first, long end);         // contents and q
};

}    // namespace mdanim
