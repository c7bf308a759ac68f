// SPDX-License-Identifier: GPL-2.0-only
// The bonds of this rank's particles as rows of springs.

#pragma once

#include "springs/spring_rows.h"

#include "lmptype.h"
#include "pointers.h"

#include <cstddef>
#include <vector>

namespace mdanim {

// A row has the bonds of a particle in the order in which their forces are summed: by the tags of partners, lower ones from the
// lowest up, then higher ones from the highest down. Partners are local particles and ghosts.
class BondRows : protected LAMMPS_NS::Pointers {
 public:
  explicit BondRows(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp) {}

  // Makes rows after lists were made, where tags or bonds differ from before; returns whether they were made.
  // `partners_may_differ`: also with the same number of bonds.
  bool update_rows(bool partners_may_differ);
  // Uses only these springs from now on, whatever bonds particles have: the springs of all particles, in the order of their tags,
  // on a rank that is alone.
  void take(SpringRows &&upper_rows);
  // Raises the error that particle i, or none where negative, has this partner, a tag.
  [[noreturn]] void lost_partner(int i, LAMMPS_NS::tagint partner) const;

  const SpringRows &all() const { return rows; }
  bool are_given() const { return given; }
  // Whether rows have only partners of a higher tag: particles stand in the order of tags, and all partners are here.
  bool are_halves() const { return upper_only; }
  int farthest() const { return farthest_offset; }    // of a partner, where rows are halves
  std::size_t bytes() const
  { return rows.bytes() + source.tag.capacity() * sizeof(LAMMPS_NS::tagint) + source.count.capacity() * sizeof(int); }

 private:
  // Data that the rows were made from, besides the bonds themselves, which they hold. Rows are kept while all of it is unchanged.
  struct Source {
    std::vector<LAMMPS_NS::tagint> tag;
    std::vector<int> count;    // of bonds
  };
  bool source_changed(bool partners_may_differ);
  void adopt(SpringRows &&made_rows, bool halves);
  void look_up(int i, bool halves, SpringRows::Row &row) const;
  bool has_changed(int i, SpringRows::Row &scratch) const;
  bool halves_suffice() const;

  SpringRows rows;
  bool upper_only = false;
  bool given = false;    // by take(), not by the particles
  Source source;
  int farthest_offset = 0;
};

}    // namespace mdanim
