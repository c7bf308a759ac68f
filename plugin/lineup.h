// SPDX-License-Identifier: GPL-2.0-only
// Particles of a rank and those of others that they have springs to, in tag order, each spring once: what is cut into blocks
// where a rank does not have all particles in that order itself.

#ifndef MDANIM_LINEUP_H
#define MDANIM_LINEUP_H

#include "blocks.h"

#include <vector>

namespace mdanim {

// Springs of the particles of a rank, by index in LAMMPS's arrays, to lower and upper partners; and the law of each type.
struct BondRows {
  const SpringRows *rows;
  const std::vector<Law> *law;
};

class Lineup {
 public:
  Lineup() = default;
  // `tag` of all particles that the rank knows, its own `nlocal` ones first.
  Lineup(int nlocal, int nall, const int *tag, const BondRows &bonds);

  int size() const { return static_cast<int>(index.size()); }
  const std::vector<int> &places() const { return index; }    // in LAMMPS's arrays, of every particle of the line
  HalfBonds halves() const;
  // Whether the same particles have the same springs, wherever LAMMPS has them.
  bool same_springs(const Lineup &other) const;
  std::size_t bytes() const;

 private:
  std::vector<int> index;
  std::vector<int> name;    // tag, with its sign changed where the particle is another rank's
  SpringRows rows;
  std::vector<Law> law;
};

}    // namespace mdanim

#endif
