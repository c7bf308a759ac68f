// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/wall: pushes particles that leave a region back, however deep and fast. A stock wall stops the run instead.

#pragma once

#include "geometry/boxes.h"
#include "lammps/fix_base.h"
#include "numbers/vec3.h"
#include "passes/pass_participant.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixMdanimWall : public mdanim::FixBase, public mdanim::PassParticipant {
 public:
  FixMdanimWall(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup_post_neighbor() override;
  void setup(int) override;
  void post_neighbor() override;
  void post_force(int) override;
  double compute_scalar() override;
  double memory_usage() override;
  void append_required_atoms(std::vector<int> &particles) const override;
  bool depends_on_positions_only() const override { return watching; }
  void add_forces(const mdanim::Positions &place, const mdanim::ForceSums &force) override;
  bool needs_all_atoms() override { return !watching; }
  double safe_displacement() const override { return clear; }

  // Stiffness of all local particles, or nullptr where all have stiffness_number().
  const double *stiffness_values() const { return stiffness.values(lmp); }
  double stiffness_number() const { return stiffness.number; }

 private:
  void take_region(int iarg);
  bool behind(const mdanim::Vec3 &x, mdanim::Vec3 &d);
  mdanim::Box box_of_all() const;
  bool is_inside(const mdanim::Box &box);
  void begin_sums();
  mdanim::Vec3 push_back(const mdanim::Vec3 &x, double k);

  std::string region_id;
  class Region *region = nullptr;
  bool convex = false;    // whether the inside is convex
  mdanim::ParticleValue stiffness;

  bool watching = false;    // only particles in `watched` can be behind before the next rebuild
  std::vector<int> watched;
  double clear = 0.0;    // no particle reaches the wall before one has gone this far

  double energy = 0.0;    // of this rank
  mdanim::Vec3 on_wall;
  double particles_behind = 0.0;
  double deepest = 0.0;    // in this run
};

}    // namespace LAMMPS_NS
