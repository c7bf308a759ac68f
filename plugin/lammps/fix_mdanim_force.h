// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/force: forces and torques on objects as a whole, in windows of time.

#pragma once

#include "forces/law.h"
#include "lammps/fix_base.h"
#include "lammps/whole_objects.h"
#include "passes/pass_participant.h"

#include <limits>
#include <map>
#include <vector>

namespace LAMMPS_NS {

// Adds the forces of forces/law.h to the particles of each object of its group, and counts their work from step to step,
//   W = sum_n sum_i (f_i(t_n) + f_i(t_{n+1}))/2 . (x_i(t_{n+1}) - x_i(t_n)).
class FixMdanimForce : public mdanim::FixBase, public mdanim::PassParticipant {
 public:
  FixMdanimForce(class LAMMPS *, int, char **);
  ~FixMdanimForce() override;

  int setmask() override;
  void init() override;
  void setup(int) override;
  void setup_pre_neighbor() override { locate(); }
  void pre_neighbor() override { locate(); }
  void post_force(int) override;
  double compute_scalar() override { return 0.0; }
  double memory_usage() override;

  void append_required_atoms(std::vector<int> &wanted) const override;
  bool depends_on_positions_only() const override { return true; }
  void add_forces(const mdanim::Positions &place, const mdanim::ForceSums &force) override;
  double safe_displacement() const override { return std::numeric_limits<double>::max(); }    // it has no lists

  // `before` goes with particles to other ranks.
  void grow_arrays(int most) override { before.resize(most); }
  void copy_arrays(int from, int to, int) override { before[to] = before[from]; }
  void set_arrays(int i) override { before[i] = {}; }
  int pack_exchange(int i, double *into) override;
  int unpack_exchange(int i, double *from) override;

 private:
  // An object in a step.
  struct PushedObject {
    mdanim::Vec3 about, centre;    // a particle of its own, and its centre of mass
    mdanim::Inertia inertia;       // about its centre
    mdanim::Vec3 swept;            // sum m (x - about) x (x - x(t_{n-1}))
  };
  void read_command(int narg, char **arg);
  const mdanim::ForceWindows &windows(int object) const;
  bool is_over() const;
  void locate();
  // Sets the forces of this step; whether they, or those of the step before or behind it, are any.
  bool turn_to_step();
  // With the places of this step in `here`: what its forces do to objects, and the work since the last step.
  void find_pushes(bool counts);
  std::vector<PushedObject> whole_objects() const;
  void find_centres(std::vector<PushedObject> &objects) const;    // of those that are not turned
  void find_motions(std::vector<PushedObject> &objects) const;    // of those that are

  bool of_objects = false;    // whether forces are those of molecules; else each object has those of molecule 0
  std::map<int, mdanim::ForceWindows> forces;    // by molecule IDs
  mdanim::WholeObjects particles;
  std::vector<int> forced;    // particles that it pushes
  // Values of objects:
  std::vector<const mdanim::ForceWindows *> of_object;
  std::vector<char> turned;
  std::vector<mdanim::ForceWindow> now;
  std::vector<mdanim::WholePush> pushes;
  std::vector<char> aside;                    // whether all of its particles have left the group
  std::vector<double> mass, heaviest;         // the latter of their particles
  std::vector<int> first;                     // the particle with the lowest tag; -1 on all ranks but its own
  std::vector<mdanim::Vec3> here, before;     // places of particles in this step and the last one; the latter where objects turn
  bool turns = false, pushes_only = false;    // whether some object has a torque; whether some has none
  double work = 0.0;                          // of all ranks
};

}    // namespace LAMMPS_NS
