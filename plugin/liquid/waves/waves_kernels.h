// SPDX-License-Identifier: GPL-2.0-only
// The loops of an update of waves over whole rows of columns, once for each set of instructions
// (simd/kernels.h). All give the same bits: every lane computes what liquid/waves/law.h says, and sums are taken by
// rows in eight parts.

#ifndef MDANIM_WAVES_KERNELS_H
#define MDANIM_WAVES_KERNELS_H

#include "liquid/waves/law.h"

#include <cstdint>

namespace mdanim {

// Arrays of links of one direction, see WaveArrays.
struct WaveLinks {
  double *edge, *top, *u, *q;               // between which heights; velocity, and the flux that made the present contents
  double *wet, *height, *faster, *units;    // see Opened; u after advection; what passes
  double *couple;
  double *moving;    // momentum before pressure, of rows
};

// Arrays of spans and links, row after row. A row is `stride` long, a multiple of 8 that leaves one place at least behind the
// last column; there is an empty row in front of the first and behind the last. Link i along x joins spans i and i + 1, along y
// spans i and i + stride. Where there is no span, there is no liquid; where there is no link, its edge is at NOWHERE.
struct WaveArrays {
  static constexpr double NOWHERE = 1e9;

  long stride;
  std::int64_t *content;
  double *capacity, *floor, *roof;    // of spans, in cells
  double *full, *rest, *phi;          // see SpanSurface
  double *volume, *head, *slope;
  double *yields, *coming;    // 1/mass of what floats above, 0 where it is held; change of the capacity, see (W6)
  double *rhs, *beside_full;
  double *delta, *last_delta;                 // phi - head, of this update and the last one
  double *scale, *x, *r, *p, *next_p, *ap;    // of the solver
  double *net;                                // units that a span gains
  double *sums;                               // of rows
  WaveLinks links[2];                         // along x, along y
};

// Rows [first, end); the first row proper is 1. No row writes where another reads or writes.
struct WaveKernels {
  static constexpr int SUMMED = 8;    // numbers of a row are summed in so many parts

  bool (*surfaces)(const WaveArrays &, const WaveLaw &, long first, long end);             // (W1); whether some span is full
  void (*open_links)(const WaveArrays &, const WaveLaw &, int d, long first, long end);    // (W2) of direction d
  void (*advect)(const WaveArrays &, const WaveLaw &, int d, long first, long end);        // (W3), (W4)
  void (*assemble)(const WaveArrays &, const WaveLaw &, bool some_full, long first, long end);    // (W5), (W6)
  void (*couple)(const WaveArrays &, long first, long end);
  void (*guess)(const WaveArrays &, bool again, long first, long end);        // x; `again`: from delta
  void (*start)(const WaveArrays &, long first, long end);                    // r = rhs - A x
  void (*turn)(const WaveArrays &, double beta, long first, long end);        // next_p = r + beta p, ap = A next_p
  void (*advance)(const WaveArrays &, double alpha, long first, long end);    // x += alpha next_p, r -= alpha ap
  void (*sum)(const WaveArrays &, const double *a, const double *b, long first, long end);    // of a b, to `sums`
  void (*heads)(const WaveArrays &, const WaveLaw &, long first, long end);          // (W7), and delta becomes the last one
  void (*push)(const WaveArrays &, const WaveLaw &, int d, long first, long end);    // (W8), and `moving`
  double (*fastest)(const WaveArrays &, long first, long end);                       // the largest |u|
  bool (*balance)(const WaveArrays &, const WaveLaw &, long first, long end);        // to `net`; whether (W9) holds
  void (*settle)(const WaveArrays &, const WaveLaw &, long first, long end);         // contents and q
};

}    // namespace mdanim

#endif
