// SPDX-License-Identifier: GPL-2.0-only
// Whether the steps of a run can be taken by passes, and by which fixes.

#pragma once

#include "passes/pass_participant.h"

#include "pointers.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {
class Fix;
}

namespace mdanim {

// Looks through LAMMPS before every run, and keeps the reason why there are no passes.
class CrewSearch : protected LAMMPS_NS::Pointers {
 public:
  explicit CrewSearch(LAMMPS_NS::LAMMPS *lmp) : Pointers(lmp) {}

  // Collects all members that act in a step, if each is known to take part in passes.
  bool find(PassCrew &crew);
  // Finds the reason why the springs were not cut for passes.
  void find_why_not_cut(const PassSprings &springs);
  // Writes the reason, once after each setup, on one rank; a run of one step takes no pass anyway.
  void tell_why(int steps);
  void forget_told() { told_why.clear(); }

  // The fixes of the crew's late participants.
  struct Late {
    LAMMPS_NS::Fix *fix;
    bool acts_at_end;
  };
  const std::vector<Late> &late() const { return found_late; }
  bool lists_matter() const { return lists_are_read; }
  bool strangers_have_lists() const { return strangers_read_lists; }

 private:
  bool plain(const std::string &reason);

  std::vector<Late> found_late;
  bool lists_are_read = false, strangers_read_lists = false;
  std::string why, told_why;    // why there are no passes in this run; the reason written since the last setup
};

}    // namespace mdanim
