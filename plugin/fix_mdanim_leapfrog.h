// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/leapfrog: advances particles by the leap-frog with friction. Wcislo 1999, eq. (3.12).

#ifndef LMP_FIX_MDANIM_LEAPFROG_H
#define LMP_FIX_MDANIM_LEAPFROG_H

#include "fix.h"
#include "particle_value.h"

namespace LAMMPS_NS {

class FixMdanimLeapfrog : public Fix {
 public:
  FixMdanimLeapfrog(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup(int) override;
  void reset_dt() override;
  void initial_integrate(int) override;
  void final_integrate() override;
  double compute_scalar() override;
  double compute_vector(int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;

 private:
  template <class Half> void half_step(Half half);
  template <class Drag, class Half> void half_step_with_drag(Half half);
  void drift();
  double largest_phi_here() const;

  bool has_drag = false, exponential = false;
  mdanim::ParticleValue lambda;
  double half_dt = 0.0;        // dt/2 in units that turn force/mass into velocity
  double lost = 0.0;           // energy taken by drag on this rank
  double largest_phi = 0.0;    // seen on this rank in this run
  double seconds = 0.0;
};

}    // namespace LAMMPS_NS

#endif
