// SPDX-License-Identifier: GPL-2.0-only
// Cutting particles and their springs into blocks for the vector units (pass.h).

#pragma once

#include "passes/pass.h"
#include "springs/distinct_rows.h"
#include "springs/spring_rows.h"

#include <vector>

namespace mdanim {

// Blocks of a set of particles that no spring leads out of; starts count from the first of these particles, ends from the first
// entry. A chunk has a bounded number of particles of one object. A block lies in one chunk.
struct Cut {
  static constexpr int CHUNK = 512;
  std::vector<Block> block;
  std::vector<Entry> entry;
  int particles = 0, farthest = 0;    // the longest offset
  int chunks = 0;
  std::size_t springs = 0;

  std::size_t bytes() const { return block.capacity() * sizeof(Block) + entry.capacity() * sizeof(Entry); }
};

// How many of the lanes that passes compute have springs.
struct LaneUse {
  double springs = 0.0, lanes = 0.0;

  // Whether enough lanes have springs: those of neighbours in the arrays must mostly lead equally far, as they do in lattices
  // that are numbered row by row.
  bool worth_it() const;
};

// Makes cuts for one number of lanes, by dynamic programming, and keeps the rows of coefficients that their entries name.
class Cutter {
 public:
  // Forgets all cuts: from now on they are for blocks of `lanes` lanes.
  void start(int lanes);
  // Cuts particles into blocks so that as few vectors of forces as possible are computed.
  Cut cut(const HalfBonds &bonds, const int *object);
  // Joins all cuts, one after the other, into a single one; there may be none.
  Cut join(const std::vector<const Cut *> &cuts);
  LaneUse use(const Cut &cut) const;
  bool rows_pile_up() const;    // most rows belong to cuts that are gone: better make all cuts anew

  int lanes() const { return width; }
  bool damped() const { return damped_coeffs.size() > 0; }    // some block is damped
  // Length of a row of coefficients: push, pull and c for a damped block, push and pull for another one, each for every lane.
  int row_length(bool of_damped) const { return (of_damped ? 3 : 2) * width; }
  const double *row(bool of_damped, unsigned law) const { return (of_damped ? damped_coeffs : coeffs).first_of(law); }
  unsigned add_row(bool of_damped, const double *row)
  { return (of_damped ? damped_coeffs : coeffs).find_or_add(row, row_length(of_damped)); }
  const double *rows() const { return coeffs.data(); }
  const double *damped_rows() const { return damped() ? damped_coeffs.data() : nullptr; }
  std::size_t bytes() const { return coeffs.bytes() + damped_coeffs.bytes(); }

 private:
  std::vector<int> lengths(const HalfBonds &bonds, const std::vector<int> &chunk) const;

  int width = 0;
  DistinctRows<double> coeffs, damped_coeffs;    // rows of equal length, one or several numbers for each lane
  unsigned usual_rows = 0;                       // number of rows when cuts were joined first after start()
};

}    // namespace mdanim
