// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/joint: joints between objects, or between an object and the world.

#pragma once

#include "joints/joint.h"
#include "lammps/fix_base.h"
#include "lammps/joint_patches.h"
#include "lammps/shared_motion.h"
#include "lammps/stateful.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Every rank computes all joints, from places and velocities that ranks share, and pushes its own particles of the group.
class FixMdanimJoint : public mdanim::FixBase, public mdanim::Stateful {
 public:
  FixMdanimJoint(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup_pre_neighbor() override { locate(); }
  void pre_neighbor() override { locate(); }
  void setup(int) override;
  void post_force(int) override;
  double compute_scalar() override;
  double compute_array(int joint, int column) override;
  double memory_usage() override;

  void write_restart(FILE *) override;
  void restart(char *) override;
  mdanim::StateRecords pack() const override;
  void unpack(const mdanim::StateRecords &records) override;

 private:
  void read_words(int narg, char **arg);
  // Particles of the patches of joints, ascending, each once.
  static std::vector<tagint> tags_of(const std::vector<mdanim::Joint> &of);
  void number_particles();
  void locate();
  void expect_particles(const std::vector<mdanim::Joint> &of) const;
  template <class Step> void each_joint(const Step &step);

  tagint lowest_of(int object) const;    // 0 of the world

  std::vector<mdanim::JointWords> words;
  std::vector<mdanim::Joint> joints;    // none where there is a problem
  std::vector<char> pushes;             // whether the fix acts on both ends of each, as it was made
  std::map<int, tagint> lowest_tags;    // of objects with joints
  std::string problem;                  // why there are no joints
  mdanim::SharedMotion shared;
  // Members of the patches of all joints, one after the other: their numbers among shared particles, where these are, and the
  // local particle that is pushed, if any.
  std::vector<int> number, row, target;
  std::vector<char> acts;    // joints with a particle in the group
  mdanim::JointAccount account;
  bool is_taken_up = false;                         // since the last setup
  std::optional<mdanim::StateRecords> restarted;    // state of a restart file, until a run begins
};

}    // namespace LAMMPS_NS
