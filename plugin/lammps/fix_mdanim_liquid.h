// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/liquid: a basin of liquid that solids displace, and that lifts and slows them. Wcislo 1999, sec. 4.

#pragma once

#include "lammps/buoyancy.h"
#include "lammps/fix_base.h"
#include "lammps/liquid_command.h"
#include "lammps/moving_planes.h"
#include "lammps/near_liquid.h"
#include "lammps/solid_samples.h"
#include "lammps/stateful.h"
#include "lammps/world_sums.h"
#include "liquid/basin.h"
#include "passes/pass_participant.h"

#include <memory>
#include <vector>

namespace LAMMPS_NS {

// Supplies the basin (liquid/basin.h) with solids (solid_samples.h) and time, and Buoyancy (buoyancy.h) with the particles near
// the liquid (near_liquid.h).
class FixMdanimLiquid : public mdanim::FixBase,
                        public mdanim::PassParticipant,
                        public mdanim::PassLiquid,
                        public mdanim::Stateful {
 public:
  FixMdanimLiquid(class LAMMPS *, int, char **);
  ~FixMdanimLiquid() override;

  int setmask() override;
  void init() override;
  void setup(int) override;
  void setup_post_neighbor() override;
  void post_neighbor() override;
  void post_force(int) override;
  void end_of_step() override;
  double compute_scalar() override;
  double compute_array(int, int) override;
  double memory_usage() override;
  void grow_arrays(int most) override;
  void copy_arrays(int from, int to, int) override;
  void set_arrays(int i) override;
  int pack_exchange(int i, double *into) override;
  int unpack_exchange(int i, double *from) override;
  int modify_param(int, char **) override;
  void append_required_atoms(std::vector<int> &particles) const override;
  bool needs_all_atoms() override;
  void equip(const mdanim::Kernels &, const mdanim::Threads &threads) override { use(threads); }
  bool join(mdanim::PassCrew &crew) override;
  bool joins(const mdanim::PassIntegrator &integrator) override;
  mdanim::LiquidScales scales() const override { return buoyancy.scales(*basin, true); }
  double top_of_near() const override { return mdanim::NearLiquid::top_of_near(*basin); }
  const std::vector<int> &near_particles() const override { return near.all(); }
  long long listed() const override { return near.listed(); }
  bool is_near(int i) const override { return near.marks()[i]; }
  std::function<mdanim::Immersed<double>(int)> immersed(const double *lambda) const override
  { return buoyancy.immersed(near.marks(), lambda); }
  mdanim::InLiquid *kept() override { return basin->acts_on_cells() ? buoyancy.kept.data() : nullptr; }
  void parts_below(const double *const *x, int first, int many, double *part) const override
  { buoyancy.parts_below(*basin, x, first, many, part); }
  void split(const std::vector<int> *in_arrays) override { near.split(in_arrays, *basin); }
  bool is_due() override;
  void update_liquid() override;
  void acted(double work, double lost, double fastest, double seconds) override;
  double safe_displacement() const override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  // One record of the whole: the basin's state with the energies. And one for each object: the values of waves at its particles.
  mdanim::StateRecords pack() const override;
  void unpack(const mdanim::StateRecords &records) override;

  // For liquid_c.cpp.
  const mdanim::Basin &liquid() const { return *basin; }

 private:
  bool makes_waves() const { return command.model == mdanim::LiquidCommand::Model::WAVES; }
  std::vector<mdanim::Keyword> free_keywords();
  void use(const mdanim::Threads &now);
  void tell_numbers();
  void pour();
  void move_basin();
  void need_setup() const;
  double fastest_near();
  template <class Work> void in_basin(Work &&work);
  void find_near(double margin);

  mdanim::WorldSums sums;
  mdanim::LiquidCommand command;
  mdanim::Buoyancy buoyancy;
  mdanim::SolidSamples solids;
  mdanim::NearLiquid near;
  mdanim::MovingPlanes moving;    // of the basin
  std::unique_ptr<mdanim::Basin> basin;

  bool in_passes = false;              // whether passes move particles near the liquid
  bool changed_since_setup = false;    // solids, by fix_modify
  bool has_looked = false;             // so that the values at particles are known until the next update
  double outer_before = 0.0;           // Basin::Impulses::outer when the fix was made, or its state was set
  bigint asked = -1;                   // step for which it is known whether an update is due
  bool due_then = false;
  double look_seconds = 0.0;
};

}    // namespace LAMMPS_NS
