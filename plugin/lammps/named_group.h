// SPDX-License-Identifier: GPL-2.0-only
// A style's argument that is a group besides its own, or none.

#pragma once

#include "pointers.h"

#include <string>

namespace mdanim {

// A group by its name: LAMMPS deletes such a group without asking the style and may give its bit to another one.
class NamedGroup {
 public:
  NamedGroup() = default;    // none
  // `style` begins messages, `iarg` is the place of the word, for the caret. Raises a LAMMPS error when there is no such group.
  NamedGroup(LAMMPS_NS::LAMMPS *lmp, const std::string &style, int iarg, const char *word);

  bool given() const { return !name.empty(); }
  // Looks the group up again; to be called before each setup. Raises a LAMMPS error when it has been deleted.
  void init(LAMMPS_NS::LAMMPS *lmp);
  int bit() const { return number; }    // 0 for none

 private:
  std::string style, name;
  int number = 0;
};

}    // namespace mdanim
