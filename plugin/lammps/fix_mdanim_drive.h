// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/drive: particles that are held go where functions of time say.

#pragma once

#include "drives/law.h"
#include "lammps/fix_base.h"

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Sets places of all particles of its group at the beginning of each step, with the mean velocity of the step, and at its end the
// mean of this and the next one, as the leap-frog has both; counts the work that this takes:
// -F dx with the mean of the forces before and after the step.
class FixMdanimDrive : public mdanim::FixBase {
 public:
  FixMdanimDrive(class LAMMPS *, int, char **);
  ~FixMdanimDrive() override;

  void post_constructor() override;
  int setmask() override;
  void init() override;
  void setup(int) override;
  void initial_integrate(int) override;
  void final_integrate() override;
  void end_of_step() override;
  double compute_scalar() override { return 0.0; }
  void write_restart(FILE *) override;
  void restart(char *) override;

  // Where an object was at the step before, is now, and will be at the next one; null for one that no motion is given for.
  struct Ways {
    mdanim::DrivenPlace before, now, next;
  };
  const Ways *ways_of(int molecule);
  // Whether there is one motion, a displacement alone, of all that it moves.
  bool shifts() const;
  // Where this one was some time ago.
  mdanim::DrivenPlace place_before(double ago) const;
  // Whether an object goes its way in this step; not from its release on, and where no motion is given for it.
  bool holds(int molecule) const;
  // Objects of which some particle is in the group, on any rank; all ranks ask together.
  std::set<int> present() const;

 private:
  void read_command(int narg, char **arg);
  void read_motions_of(const char *file);
  double **home() const;
  void find_ways();
  const Ways &ways(int i);
  void set_whole_velocities();
  bool guides(int i);    // whether a local particle goes its way in this step
  bool is_due() const;
  void release(bigint step);
  double time(bigint step) const;

  bool tells_alone = false;                       // moves no particle, and tells other fixes where planes are
  bool of_objects = false;                        // whether motions are those of molecules; else there is one, of molecule 0
  std::map<int, mdanim::DrivenMotion> motions;    // by molecule IDs
  std::map<int, Ways> ways_now;
  std::optional<bigint> found_at;    // step of `ways_now`
  int last_molecule = -1;
  const Ways *last_ways = nullptr;
  std::string home_name, own_home;    // the property with the places at the start; the fix that we made for it, or none
  std::string integrator;             // ID of the fix that moves what is released; empty for none
  mdanim::NamedGroup left;            // by what is released
  int joined = 0;                     // bit of the group of `integrator`
  bool releases = false;              // whether some motion ends
  bigint since;                       // step at which time is 0
  double dt_before = 0.0;
  double work = 0.0;    // on this rank
};

}    // namespace LAMMPS_NS
