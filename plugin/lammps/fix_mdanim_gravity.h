// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/gravity: m g on every particle. Wcislo 1999, eq. (3.8).

#pragma once

#include "lammps/fix_base.h"
#include "numbers/vec3.h"
#include "passes/pass_participant.h"

namespace LAMMPS_NS {

// Adds m g to every particle of its group in plain steps, and gives passes the masses and g.
class FixMdanimGravity : public mdanim::FixBase, public mdanim::PassGravity {
 public:
  FixMdanimGravity(class LAMMPS *, int, char **);

  int setmask() override;
  void setup(int) override;
  void post_force(int) override;
  double compute_scalar() override;

  double pulled(int i) const override;
  const mdanim::Vec3 &acceleration() const override { return g; }
  void took(double more) override { seconds += more; }

 private:
  mdanim::Vec3 g;
};

}    // namespace LAMMPS_NS
