// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/hand: hands that pull at material points of objects.

#pragma once

#include "hands/law.h"
#include "lammps/fix_base.h"
#include "lammps/shared_motion.h"
#include "lammps/stateful.h"
#include "passes/pass_participant.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

// Every rank computes the forces of all hands, from places and velocities that ranks share, and pushes its own particles of the
// group. Counts their work from step to step,
//   W = sum_n dt (F(t_n) + F(t_{n+1}))/2 . v^{n+1/2}.
// Its state are the forces of hands in the last step, which follow from velocities of half a step before.
class FixMdanimHand : public mdanim::FixBase, public mdanim::PassParticipant, public mdanim::Stateful {
 public:
  FixMdanimHand(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup(int) override;
  void setup_pre_neighbor() override { locate(); }
  void pre_neighbor() override { locate(); }
  void post_force(int) override;
  int modify_param(int, char **) override;
  double compute_scalar() override { return 0.0; }
  double memory_usage() override { return static_cast<double>(shared.bytes()); }

  void append_required_atoms(std::vector<int> &wanted) const override;

  void write_restart(FILE *) override;
  void restart(char *) override;
  mdanim::StateRecords pack() const override;
  void unpack(const mdanim::StateRecords &) override;

 private:
  struct Held {
    mdanim::Hand hand;
    std::vector<int> numbers;    // of its particles among shared ones
    mdanim::Vec3 force;          // of the last step
    bool acts = true;            // its particles are in the group
  };

  void choose();
  void locate();
  bool is_idle() const;
  mdanim::HandMotion point_of(const Held &one) const;
  int object_of(const Held &one) const;
  // Force at a place of the hand: that of a state, where there is one.
  mdanim::Vec3 force_at(const Held &one, const mdanim::HandMotion &now, const mdanim::HandMotion &point);
  void go_on(Held &one);
  // Adds the forces of this step; gives the power of those of the last one and this.
  double pull();

  std::vector<Held> held;
  mdanim::SharedMotion shared;
  double work = 0.0;    // of all ranks
  // Forces of a state by objects and first keys, in the order of the hands; until the first step.
  std::multimap<std::pair<int, double>, mdanim::Vec3> acted;
  std::optional<mdanim::StateRecords> restarted;    // of a restart file, until a run begins
};

}    // namespace LAMMPS_NS
