// SPDX-License-Identifier: GPL-2.0-only
// fix ID group mdanim/test/rig AX AY AZ FREQUENCY MEMORY [tether TAG1 MOL1 TAG2 MOL2 K LENGTH]…: all that a feature may do, for
// tests of how its columns, its records and its work are kept. The group has the particles that move, driven ones among them.
//
// Particles with d_driven go to and fro around d2_home by A sin(2 pi FREQUENCY t); what they give to others is counted. A tether
// is a spring of K between two particles of two objects. Where MEMORY is not 0, forces depend on what was before: on the way of
// each particle (d2_way), on the largest length of each spring (d2_most), on the steps that an object has gone through (d_turns),
// and on those in which a tether was longer than LENGTH, a record of the pair; their work is counted, too.

#pragma once

#include "lammps/fix_base.h"
#include "lammps/stateful.h"
#include "numbers/vec3.h"

#include <map>
#include <vector>

namespace LAMMPS_NS {

class FixMdanimTestRig : public mdanim::FixBase, public mdanim::Stateful {
 public:
  FixMdanimTestRig(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup(int) override;
  void initial_integrate(int) override;
  void post_force(int) override;
  void end_of_step() override;
  double compute_scalar() override;
  mdanim::StateRecords pack() const override;
  void unpack(const mdanim::StateRecords &records) override;

 private:
  struct End {
    tagint tag;
    int object;
  };
  struct Tether {
    End a, b;
    double k, length;
    mdanim::Vec3 more;    // force of what was before, in the last step
  };
  // A tether now: the vector between its ends, its length, and the ends on this rank, -1 for none.
  struct Stretched {
    mdanim::Vec3 way;
    double length;
    int a, b;
  };
  Stretched stretch(const Tether &tether) const;
  int here(tagint tag) const;
  bool is_driven(int i) const;
  double **rows(const char *name) const;
  double *values(const char *name) const;
  void remember();
  void push(double dt);
  mdanim::Vec3 remembered(int i) const;

  mdanim::Vec3 amplitude;
  double frequency, memory;
  std::vector<Tether> tethers;
  std::map<mdanim::StateKey, double> taut;    // steps of pairs
  double work = 0.0;                          // on this rank
};

}    // namespace LAMMPS_NS
