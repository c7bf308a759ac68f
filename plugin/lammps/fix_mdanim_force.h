// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/force: forces and torques on objects as a whole, in windows of time.

#pragma once

#include "forces/law.h"
#include "lammps/fix_base.h"
#include "lammps/whole_objects.h"
#include "passes/pass_participant.h"

#include <map>
#include <vector>

namespace LAMMPS_NS {

// Adds the forces of forces/law.h to the particles of each object of its group, and counts their work from step to step,
//   W = sum_n dt sum_i (f_i(t_n) + f_i(t_{n+1}))/2 . v_i^{n+1/2}.
class FixMdanimForce : public mdanim::FixBase, public mdanim::PassParticipant {
 public:
  FixMdanimForce(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup(int) override;
  void setup_pre_neighbor() override { particles.locate(); }
  void pre_neighbor() override { particles.locate(); }
  void post_force(int) override;
  double compute_scalar() override { return 0.0; }
  double memory_usage() override { return particles.bytes(); }

  void append_required_atoms(std::vector<int> &wanted) const override;

 private:
  void read_command(int narg, char **arg);
  const mdanim::ForceWindows &windows(int object) const;
  bool is_over() const;
  // Whether anything acts in this step or did in the last one.
  bool acts();
  void find_pushes();
  void push_all() const;
  void count_work(const std::vector<mdanim::WholePush> &before);

  bool of_objects = false;    // whether forces are those of molecules; else each object has those of molecule 0
  std::map<int, mdanim::ForceWindows> forces;    // by molecule IDs
  mdanim::WholeObjects particles;
  std::vector<mdanim::ForceWindow> now;    // of objects
  std::vector<mdanim::WholePush> pushes;
  std::vector<mdanim::WholeObjects::MassProperties> bodies;
  std::vector<double> mass;
  bool turns = false, acted = false;
  double work = 0.0;    // of all ranks
};

}    // namespace LAMMPS_NS
