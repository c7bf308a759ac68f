// SPDX-License-Identifier: GPL-2.0-only
// Particles of a rank and those of others that they have springs to, in tag order, each spring once: the line that is cut into
// blocks where a rank does not have all particles in that order itself.

#pragma once

#include "passes/cutter.h"

#include <functional>
#include <unordered_map>
#include <vector>

namespace mdanim {

// Particles and bonds known to a rank, by index in LAMMPS's arrays, its own particles first; bonds are at both ends.
struct Bonded {
  int own;
  const int *tag, *object;
  const int *bonds;                            // number of bonds of each own particle
  const int *const *type;                      // 0 and less: switched off
  const int *const *partner;                   // tags
  std::function<int(int tag)> find;            // index of a partner, negative where it is not known;
  std::function<void(int i, int tag)> lost;    // reports that error; i is negative where no particle has a bond to it any more
};

// The line of a rank's own particles and of the ghosts that they have springs to, in tag order, with each spring once. It is cut
// where a rank does not have all particles in that order. It is made of a piece for each object, and keeps the pieces, with their
// cuts, of objects whose own particles have not changed.
class TagOrder {
 public:
  // Particles that stand side by side: those of one object, and all partners of its own ones. Objects whose own particles are
  // unchanged keep their piece, with the cut.
  struct Piece {
    std::vector<int> own;       // tags of this rank's particles, ascending
    std::vector<int> tag;       // tags of all particles, ascending
    std::vector<int> object;    // object of each particle
    SpringRows rows;            // to partners of a higher tag, of springs with an end that is this rank's
    Cut cut;
    bool is_cut = false;
  };

  void take(const Bonded &known);
  void forget() { *this = TagOrder(); }

  std::vector<Piece> &pieces() { return all; }
  bool changed() const { return differs; }    // whether the last take() changed pieces or their order
  int size() const { return static_cast<int>(index.size()); }
  const std::vector<int> &places() const { return index; }    // index in LAMMPS's arrays of every particle of the line
  std::size_t bytes() const;

 private:
  struct Run {
    int begin, end, object;    // range of own particles in tag order
  };
  void sort(const Bonded &known);
  bool take_by_objects(const Bonded &known, const std::vector<Run> &runs);
  Piece made(const Bonded &known, const Run &run) const;
  static void refuse_lost_partner(const Bonded &known, int partner);

  std::vector<int> ordered;    // own particles in tag order, by index in LAMMPS's arrays
  std::vector<Piece> all;
  std::vector<int> index;
  bool differs = true;
};

}    // namespace mdanim
