// SPDX-License-Identifier: GPL-2.0-only
// run_style verlet/mdanim: run_style verlet, after which it is called because fixes of LAMMPS look for that word, that takes the steps of springs, gravity and leap-frog in one pass over the particles.

#ifndef LMP_VERLET_MDANIM_H
#define LMP_VERLET_MDANIM_H

#include "blocks.h"
#include "guest.h"
#include "lineup.h"
#include "verlet.h"

namespace LAMMPS_NS {

class VerletMdanim : public Verlet {
 public:
  VerletMdanim(class LAMMPS *, int, char **);

  void setup(int) override;
  void setup_minimal(int) override;
  void run(int) override;
  double memory_usage() override;
  long long passes() const { return passed; }

 private:
  void spare_bond_list();
  bool find_players();
  bool cut();
  bool cut_for_ranks();
  bool cut_line();
  void meet_ghosts();
  int take_steps(int step, int most);
  bigint next_stop() const;
  double how_far_lists_last() const;
  bool lists_last(double more);
  bool lists_are_due();
  bool look_again();
  double farthest() const;
  void start_blocks();
  void leave_blocks();
  void hold_back();
  void one_pass(bool guests_see_all);
  void guests_turn();

  void begin_step();
  void finish_step();
  bool rebuild_lists();

  const mdanim::Width *width;
  mdanim::Blocks blocks;
  mdanim::Pass pass = {};
  bigint cut_for = -1;          // version of the springs
  std::vector<int> object;      // and molecule of each particle
  bool worth_it = false;
  mdanim::Lineup line;            // with other ranks: what is cut
  std::vector<int> sent;          // own particles that other ranks have as ghosts
  bigint decided_for = -1;        // build of lists after which all ranks agreed on worth_it
  long long passed = 0;

  // found before every run
  class BondMdanimHarmonic *bond = nullptr;
  class FixMdanimLeapfrog *leapfrog = nullptr;
  class FixMdanimGravity *gravity = nullptr;
  struct Player {
    class Fix *fix;
    mdanim::Guest *guest;
    bool acts_at_end;
  };
  std::vector<Player> guests;

  bool lists_matter = false;
  bool strangers_have_lists = false;
  double strayed = 0.0;        // no particle has moved farther since lists were made
  double last = 0.0;           // how far any may go
  bigint made_for = -1;        // build of lists that the blocks' motion was told after
  std::vector<int> wanted;     // particles that guests are concerned with
};

}    // namespace LAMMPS_NS

#endif
