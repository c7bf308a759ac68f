// SPDX-License-Identifier: GPL-2.0-only
// The springs of all particles, in rows.

#ifndef MDANIM_SPRING_ROWS_H
#define MDANIM_SPRING_ROWS_H

#include "laws/spring.h"

#include <cstddef>
#include <unordered_map>
#include <vector>

namespace mdanim {

// One row for each particle. Most particles of a lattice have partners of the same kinds equally far on in the arrays: rows that
// are equal in this are kept once, 4 bytes for each particle instead of 8 for each spring.
class SpringRows {
 public:
  struct Link {
    int offset;    // partner - i
    int type;      // of the bond
    bool operator==(const Link &other) const { return offset == other.offset && type == other.type; }
  };
  // In the order in which forces are summed: `lower` partners of lower tag, ascending, then upper ones, descending.
  struct Row {
    std::vector<Link> link;
    int lower = 0;
  };
  struct Links {
    const Link *first, *last;
    const Link *begin() const { return first; }
    const Link *end() const { return last; }
    int size() const { return static_cast<int>(last - first); }
  };

  explicit SpringRows(int particles = 0) { kind.reserve(particles); }
  void add(const Row &row);                                              // of the next particle
  void close() { known = {}; }                                           // that was the last
  bool is(int i, const Row &row) const { return same(kind[i], row); }    // the row of particle i
  Links operator[](int i) const { return links(kind[i]); }
  int lower(int i) const { return lowers[kind[i]]; }

  int size() const { return static_cast<int>(kind.size()); }
  std::size_t total() const { return all; }    // length of all rows

  std::size_t bytes() const;

 private:
  Links links(int k) const { return {distinct.data() + first[k], distinct.data() + first[k + 1]}; }
  bool same(int k, const Row &row) const;

  std::vector<int> kind;                // of row, for each particle
  std::vector<int> first{0}, lowers;    // for each kind
  std::vector<Link> distinct;           // of all kinds
  std::size_t all = 0;
  std::unordered_multimap<std::size_t, int> known;    // kinds by hash, until all rows are here
};

// Rows to partners of a higher tag alone, so each spring once, of particles in the order of tags; and the law of each type.
struct HalfBonds {
  const SpringRows *rows;
  const SpringCoeffs *law;
};

}    // namespace mdanim

#endif
