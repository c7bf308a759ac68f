// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/liquid: a basin of liquid that solids displace, and that lifts and slows them. Wcislo 1999, sec. 4.

#pragma once

#include "lammps/buoyancy.h"
#include "lammps/fix_base.h"
#include "lammps/stateful.h"
#include "liquid/basin.h"
#include "liquid/rank_sums.h"
#include "passes/pass_participant.h"
#include "threads/row_slabs.h"

#include <memory>
#include <string>
#include <vector>

namespace mdanim {
class WaveBasin;
}    // namespace mdanim

namespace LAMMPS_NS {

// Supplies the basin (liquid/basin.h) with solids and time, and Buoyancy (buoyancy.h) with the particles near the liquid.
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
  bool joins(const double *lambda) override;
  mdanim::LiquidScales scales() const override { return buoyancy->scales(*basin, true); }
  double top_of_near() const override;
  const std::vector<int> &near_particles() const override { return near; }
  long long listed() const override { return lists; }
  bool is_near(int i) const override { return near_marks[i]; }
  std::function<mdanim::Immersed<double>(int)> immersed() const override { return buoyancy->immersed(near_marks); }
  mdanim::InLiquid *kept() override;
  void split(const std::vector<int> *in_arrays) override;
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
  void use(const mdanim::Threads &now)
  {
    threads = now;
    basin->use(threads);
    buoyancy->use(threads);
  }

  class WorldSums : public mdanim::RankSums {
   public:
    explicit WorldSums(const LAMMPS *lmp) : lmp(lmp) {}
    bool alone() const override;
    bool first() const override;
    void add(int *values, int count) const override;
    void add_wide(std::int64_t *values, int count) const override;
    void lowest(int *values, int count) const override;

   private:
    const LAMMPS *lmp;
  };

  void tell_numbers();
  static bool is_maker(const char *word);
  void add_maker(mdanim::WaveBasin &waves, int iarg, char **arg, double depth);
  void keyword(int iarg, char **arg, mdanim::Basin::Pace &pace);
  mdanim::Basin::AddBodies bodies(bool still);
  mdanim::Basin::AddBodies bodies_near();
  std::vector<int> particles_of(bool still) const;
  int row_at(double y) const;
  void add_particles(mdanim::Occupancy &into, const std::vector<int> &these, double below) const;
  void add_bodies(mdanim::Occupancy &into, const std::vector<int> &these, const mdanim::NearCells &cells, bool still,
                  double below);
  void add_mass(mdanim::Occupancy &into, const std::vector<int> &these, double below);
  bool by_cells() const { return lattice_cells.given() && model != Model::PAPER; }
  void pour();
  void need_setup() const;
  double fastest_near();
  double fastest_in_arrays(const std::vector<int> &these) const;
  const std::vector<int> &in_arrays() const { return is_split ? near_in_arrays : near; }    // near the liquid
  template <class Work> void in_basin(Work &&work);
  void find_near(double margin);
  double top_height(double cells) const;    // [distance]
  bool asleep() const { return none_near && basin->is_calm() && basin->moving_solid() == 0; }

  enum class Model { SURFACE, PAPER, WAVES };

  // Settings of the command.
  Model model = Model::SURFACE;
  std::string region_id, fill_id;
  double volume_asked = -1.0, level_asked = 0.0;
  bool has_level = false;
  mdanim::NamedGroup still_group;
  mdanim::ParticleTable lattice_cells;
  mdanim::ParticleColumn softness;    // volume over Young's modulus

  WorldSums sums;
  mdanim::Threads threads;
  mdanim::RowSlabs slabs;
  std::unique_ptr<mdanim::Basin> basin;
  std::unique_ptr<mdanim::Buoyancy> buoyancy;

  // The particles near the liquid.
  bool none_near = false;     // on any rank, before the next rebuild of lists
  double listed_top = 0.0;    // of the liquid when particles were listed
  double lowest = 0.0;        // particle of this rank when lists were made
  std::vector<int> near;
  long long lists = 0;    // made so far

  // State of passes that move particles near the liquid (PassLiquid).
  bool in_passes = false;
  std::vector<char> near_marks;       // of all particles of this rank
  bool is_split = false;              // whether the arrays hold only some particles
  std::vector<int> near_in_arrays;    // those of them that are near the liquid
  double fastest_in_passes = -1.0;    // square of the largest speed of the others

  bool changed_since_setup = false;    // by fix_modify
  bool has_looked = false;             // so that the values at particles are known until the next update
  bigint asked = -1;                   // step for which it is known whether an update is due
  bool due_then = false;
  double look_seconds = 0.0;
};

}    // namespace LAMMPS_NS
