// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/gravity: m g on every particle. Wcislo 1999, eq. (3.8).

#ifndef LMP_FIX_MDANIM_GRAVITY_H
#define LMP_FIX_MDANIM_GRAVITY_H

#include "fix.h"
#include "laws/vec3.h"

namespace LAMMPS_NS {

class FixMdanimGravity : public Fix {
 public:
  FixMdanimGravity(class LAMMPS *, int, char **);

  int setmask() override;
  void setup(int) override;
  void post_force(int) override;
  double compute_scalar() override;
  double compute_vector(int) override;

  // For run_style verlet/mdanim, which does its work in passing: mass that it pulls at, acceleration, and the time that went to
  // it.
  double pulled(int i) const;
  const mdanim::Vec3 &acceleration() const { return g; }
  void took(double more) { seconds += more; }

 private:
  mdanim::Vec3 g;
  double seconds = 0.0;
};

}    // namespace LAMMPS_NS

#endif
