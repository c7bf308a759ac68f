// SPDX-License-Identifier: GPL-2.0-only
// run_style verlet/mdanim: run_style verlet, after which it is called because fixes of LAMMPS look for that word, that takes the
// steps of springs, gravity and leap-frog in one pass over the particles.

#ifndef LMP_VERLET_MDANIM_H
#define LMP_VERLET_MDANIM_H

#include "engine/boxes.h"
#include "engine/kernels.h"
#include "engine/pass_participant.h"
#include "engine/simd_blocks.h"
#include "engine/tag_order.h"
#include "styles/ghosts.h"
#include "styles/verlet.h"

namespace LAMMPS_NS {

class VerletMdanim : public Verlet {
 public:
  VerletMdanim(class LAMMPS *, int, char **);

  void setup(int) override;
  void setup_minimal(int) override;
  void run(int) override;
  double memory_usage() override;
  long long passes() const { return passed; }
  long long held_back() const { return moved_alone; }    // particles, all passes together

 private:
  void spare_bond_list();
  bool find_players();
  bool cut();
  bool cut_for_ranks();
  mdanim::LaneUse cut_line(std::vector<mdanim::Home> &home);
  bool overflows() const;
  void meet_ghosts();
  int take_steps(int step, int most);
  bigint next_stop() const;
  void tell_limits();
  bool lists_last(double more);
  bool lists_are_due();
  bool look_again();
  void way_begins();
  void refuse_if_moved();
  void run_passes(int n);
  template <class Where> double way_left(Where where) const;
  double way_left() const;    // as they stand in LAMMPS
  double way_to_strangers(const mdanim::Box &own, const mdanim::Box &all) const;
  bool follows(int d, int side) const;
  void prepare_passes();
  void leave_blocks();
  void give_out_account();
  void hold_back();
  void one_pass(bool participants_see_all);
  void early_participants_turn();
  void late_participants_turn();

  void begin_step();
  void finish_step();
  bool rebuild_lists();

  const mdanim::Kernels *told = nullptr, *kernels = nullptr;    // in the input script; what blocks are cut for
  mdanim::SimdBlocks blocks;
  mdanim::Pass pass = {};
  bigint cut_for = -1;        // version of the springs
  std::vector<int> object;    // and molecule of each particle
  bool worth_it = false;
  bool overflowed = false;                   // in this run, on some rank
  mdanim::LaneUse line_use;                  // of this rank
  mdanim::TagOrder line;                     // with other ranks: what is cut,
  std::vector<mdanim::SpringCoeffs> laws;    // for these
  mdanim::Ghosts ghosts;                     // and whom they tell of it
  int participants_look = 0;                 // whether participants of any rank are concerned with particles
  std::vector<int> sent;                     // own particles that other ranks have as ghosts
  bigint decided_for = -1;                   // build of lists after which all ranks agreed on worth_it
  long long passed = 0, moved_alone = 0;

  // found before every run
  class BondMdanimHarmonic *bond = nullptr;
  class FixMdanimLeapfrog *leapfrog = nullptr;
  class FixMdanimGravity *gravity = nullptr;
  struct Player {
    class Fix *fix;
    mdanim::PassParticipant *participant;
    bool acts_at_end;
  };
  std::vector<Player> early, late;    // participants whose forces are asked for before a pass, and those who come after it

  bool lists_matter = false;
  bool strangers_have_lists = false;
  // How far any particle may go from where it stood when lists were made before they must be made anew: all told, and with the
  // drift of all particles taken off.
  double limit = 0.0, limit_but_for_drift = 0.0;
  double left = 0.0;                       // how much farther, at least
  double whole_way = 0.0;                  // that, when lists were new
  bigint whole_way_for = -1;               // the build of these
  bool ghosts_are_met = false;             // where they are now
  int local_then = -1, ghosts_then = 0;    // particles at the end of the last run, negative after a setup
  double narrowest[3] = {};                // share of the box that a rank has along each axis, the least of all
  bigint made_for = -1;                    // build of lists that the blocks' motion was told after
  mdanim::Positions places;                // of the particles of an early participant
  std::vector<int> wanted;                 // particles that late participants are concerned with
};

}    // namespace LAMMPS_NS

#endif
