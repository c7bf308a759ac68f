// SPDX-License-Identifier: GPL-2.0-only
// Columns cut by solids, whose liquid makes way, and the liquid that stands at rest among them.

#pragma once

#include "liquid/cell_box.h"
#include "liquid/waves/wave_columns.h"
#include "liquid/waves/wave_loops.h"

#include <functional>
#include <vector>

namespace mdanim {

class WaveSolids {
 public:
  // Both must outlive this. Cuts the columns of an empty basin.
  WaveSolids(WaveColumns &columns, WaveRun &run);

  // As those of Waves.
  void set_solids(const std::uint16_t *part, const double *mass, double again, const CellBox *where);
  void set_walls(const std::uint16_t *held);
  std::vector<std::uint8_t> hollows(double level, const std::function<bool(int column, int z)> &floats) const;
  // (W10): liquid that is nearly at rest comes to rest. Each body of it gets its level, to the unit, and nothing more is computed
  // until a solid moves.
  void come_to_rest();

 private:
  using LinkPlace = WaveColumns::LinkPlace;
  using SpanState = WaveColumns::SpanState;
  // Liquid whose span has closed.
  struct Displaced {
    int column, z;
    Units units;
  };
  void cut_anew(int column, std::vector<std::uint8_t> &marks) const;
  std::vector<int> differing(const std::uint16_t *part, const CellBox &where) const;
  std::vector<Displaced> carry_over(const std::vector<int> &those, const std::vector<int> &changed,
                                    const std::vector<SpanState> &was);
  std::vector<SpanState> share_out(const std::vector<SpanState> &was, const std::vector<Span> &cut,
                                   std::vector<Displaced> &displaced) const;
  void place_displaced(const std::vector<Displaced> &displaced);
  void level_out(const std::vector<long> &body);

  WaveColumns &columns;
  WaveRun &run;
  WaveArrays &arrays;
  std::vector<Span> &span;
  std::vector<Units> &content;
  std::vector<std::uint8_t> walled_anew;    // columns that must be cut anew because walls have changed
};

}    // namespace mdanim
