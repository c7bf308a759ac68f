// SPDX-License-Identifier: GPL-2.0-only
// run_style verlet/mdanim: derives from run_style verlet, and its name begins with that word because fixes of LAMMPS look for it.
// It takes the steps of springs, gravity and leap-frog in one pass over the particles.

#pragma once

#include "lammps/crew_search.h"
#include "lammps/ghosts.h"
#include "lammps/split_verlet.h"
#include "passes/displacement_budget.h"
#include "passes/pass_engine.h"

#include <vector>

namespace LAMMPS_NS {

// Decides which steps are taken by passes, and does the work for LAMMPS that is not the engine's: steps of its own, lists, ranks,
// outputs.
class VerletMdanim : public SplitVerlet {
 public:
  VerletMdanim(class LAMMPS *, int, char **);

  void setup(int) override;
  void setup_minimal(int) override;
  void run(int) override;
  double memory_usage() override;
  long long passes() const { return passed; }
  int ranges() const { return engine.ranges(); }
  long points_at_planes() const { return engine.points_at_planes(); }    // in the latest pass
  const char *width() const { return engine.width(); }                   // of the latest run with passes; empty before the first
  long long held_back() const { return engine.held_back(); }             // particles, all passes together

 private:
  static constexpr int MOST_THREADS = mdanim::Team::MOST_TASKS;    // more threads cannot have a range each

  void set_width(const char *word);
  void set_threads(const char *word);
  void begin_setup();
  void spare_bond_list();
  bool find_crew();
  bool cut();
  bool cut_for_ranks();
  void refuse_if_moved();
  void equip_members() const;
  void run_passes(int n);
  int take_steps(int step, int most);
  bigint next_stop() const;
  mdanim::AtomArrays arrays() const;
  void start_passes(bool positions);
  void act_late(bool at_end);
  bool look_again();
  void leave_passes();
  void meet_ghosts();
  void tell_limits();
  void measure();
  bool spend(double way);
  bool lists_are_due() override;

  const mdanim::Kernels *told = nullptr;    // by the input script
  mdanim::CrewSearch search;
  mdanim::PassEngine engine;
  mdanim::DisplacementBudget budget;
  mdanim::Ghosts ghosts;
  std::vector<int> sent;          // own particles that other ranks have as ghosts
  bool ghosts_are_met = false;    // whether they have their present places
  int participants_look = 0;      // whether a participant reads them in the arrays, on any rank
  bool worth_it = false;          // on all ranks together,
  bigint decided_for = -1;        // as of this build of lists
  bool overflowed = false;        // in this run, on some rank
  long long passed = 0;
  int local_then = -1, ghosts_then = 0;    // particles at the end of the last run, negative after a setup
};

}    // namespace LAMMPS_NS
