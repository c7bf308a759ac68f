// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/tear: springs of bond_style mdanim/harmonic that are gone for good where they are stretched too far.

#pragma once

#include "lammps/fix_base.h"
#include "numbers/vec3.h"
#include "tearing/law.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class BondMdanimHarmonic;

// Looks at the springs of its particles before the forces of each step, and takes those that break (tearing/law.h) out of the
// rows of the bond style: the type of such a bond is negative, which LAMMPS leaves out. The property `torn` is what it goes by:
// it is that of the particles' records, and a run begins with it. Adds the forces of what remains of springs over two links,
// whose energy is its scalar.
class FixMdanimTear : public mdanim::FixBase {
 public:
  FixMdanimTear(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup_pre_force(int) override;
  void setup(int) override { pull(); }
  void pre_force(int) override;
  void post_force(int) override;
  double compute_scalar() override;

 private:
  // Values of the bonds of the particles here, in the order of their bonds.
  struct BondValues {
    double *const *limit, *const *second, *const *stored, *const *rest, *const *torn;
  };
  double **rows(const std::string &name, int each = 1) const;
  BondValues values() const;
  mdanim::Vec3 place(int i, tagint of) const;
  mdanim::Vec3 apart(int i, int b) const;
  bool breaks(int i, int b, const BondValues &now) const;
  static mdanim::Remainder remainder(int i, int b, const BondValues &now);
  int remaining(int i, int b, const BondValues &now) const;
  double account(int i, const BondValues &now) const;
  template <class Visit> void each_remainder(Visit visit) const;    // visit(i, b, how many, Remainder)
  void pull() const;

  std::string limit, second, stored, rest, torn;    // names of the properties, by bonds
  BondMdanimHarmonic *springs = nullptr;
  std::vector<int> breaking;    // bonds of one particle
  double lost = 0.0;            // energy, on this rank
};

}    // namespace LAMMPS_NS
