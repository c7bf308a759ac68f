// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/yield: springs of bond_style mdanim/harmonic whose rest length follows where they bear too much.

#pragma once

#include "lammps/bent_rings.h"
#include "lammps/fix_base.h"
#include "lammps/spring_losses.h"
#include "tearing/yield_law.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class BondMdanimHarmonic;

// Looks at springs that may yield before the forces of each step (tearing/yield_law.h), and adds to the forces of the bond style,
// which has one rest length for each type, what the growth of each changes. The property `bears` has the stretch that each bond
// of a particle bears, 0 of one that never yields; `grown`, the growth of each, is the state: it is that of the particles'
// records, and a run begins with it. Each end of a bond keeps its own copy and finds the same. The property `free` has lengths
// without load, where they are not rest lengths. Layers of particles keep bends besides, by rings (tearing/bend_law.h). The
// scalar is the energy of both beyond that of the bond style.
class FixMdanimYield : public mdanim::FixBase {
 public:
  FixMdanimYield(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup_post_neighbor() override;
  void post_neighbor() override { watch(); }
  void setup(int) override;
  void pre_force(int) override;
  void post_force(int) override;
  void final_integrate() override;
  double compute_scalar() override;
  double memory_usage() override;

  // Growth of a bond of a local particle.
  double more(int i, int slot) const { return growths()[i][slot]; }
  // The fix of this style that there is; null for none.
  static const FixMdanimYield *of(LAMMPS *lmp);

 private:
  // A bond of a local particle, in rows of the particles, as they have them; `factor` is what its growth adds to F_i/r_ij.
  struct YieldBond {
    int i, slot, j;
    double K, r0, length, most, factor;
  };

  int find(const std::string &property) const;
  void find_properties();
  double **growths() const;
  void watch();
  double now(const YieldBond &one) const;
  mdanim::LoadFree first(const YieldBond &one) const;
  bool is_gone(const YieldBond &one) const;

  std::string grown, bears, free;                        // names of properties; the last one empty for none
  int of_growths = -1, of_most = -1, of_lengths = -1;    // their places among LAMMPS's
  BondMdanimHarmonic *springs = nullptr;
  std::vector<YieldBond> watched;
  mdanim::BentRings rings;
  mdanim::SpringLosses losses;
};

}    // namespace LAMMPS_NS
