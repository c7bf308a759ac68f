// SPDX-License-Identifier: GPL-2.0-only
// The springs of all particles, in rows.

#pragma once

#include "springs/distinct_rows.h"
#include "springs/law.h"

#include <cstddef>
#include <vector>

namespace mdanim {

// One row for each particle. Most particles of a lattice have partners of the same kinds at the same distances in the arrays.
// Such equal rows are kept once: 4 bytes for each particle instead of 8 for each spring.
class SpringRows {
 public:
  struct Link {
    int offset;    // partner - i
    int type;      // of the bond
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
  void add(Row &row);                   // adds the row of the next particle
  void close() { distinct.close(); }    // no row is added after this
  bool is(int i, Row &row) const;       // the row of particle i
  Links operator[](int i) const { return {distinct.first_of(kind[i]), end(i)}; }
  int lower(int i) const { return end(i)->offset; }

  int size() const { return static_cast<int>(kind.size()); }
  std::size_t total() const { return all; }    // length of all rows
  std::size_t bytes() const { return kind.capacity() * sizeof(unsigned) + distinct.bytes(); }

 private:
  // Rows are kept with one more link at the end, whose `offset` is `lower`.
  const Link *end(int i) const { return distinct.last_of(kind[i]) - 1; }

  std::vector<unsigned> kind;    // of row, for each particle
  DistinctRows<Link> distinct;
  std::size_t all = 0;
};

inline void SpringRows::add(Row &row)
{
  all += row.link.size();
  row.link.push_back({row.lower, 0});
  kind.push_back(distinct.find_or_add(row.link.data(), row.link.size()));
  row.link.pop_back();
}

inline bool SpringRows::is(int i, Row &row) const
{
  row.link.push_back({row.lower, 0});
  const bool same = distinct.is(kind[i], row.link.data(), row.link.size());
  row.link.pop_back();
  return same;
}

// Rows to partners of a higher tag only, so that each spring occurs once, of particles in the order of tags; and the law of each
// bond type.
struct HalfBonds {
  const SpringRows *rows;
  const SpringCoeffs *law;
};

}    // namespace mdanim
