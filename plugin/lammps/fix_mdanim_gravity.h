// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/gravity: m g on every particle. Wcislo 1999, eq. (3.8).

#pragma once

#include "gravity/law.h"
#include "lammps/fix_base.h"
#include "numbers/vec3.h"
#include "numbers/vector_path.h"
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
  bool steady() const override { return path.empty(); }
  const mdanim::Vec3 &acceleration() const override { return g; }
  mdanim::Vec3 turn_to_step() override;
  void worked(double power) override;
  void took(double more) override { seconds += more; }

 private:
  void read_path(int narg, char **arg);
  double now() const;
  void pull() const;
  mdanim::Vec3 momentum() const;    // of the particles here that it pulls at

  mdanim::Vec3 g;
  mdanim::VectorPath path;          // empty where g stays
  mdanim::AccelerationWork work;    // of what is here, counted where there is a path
};

}    // namespace LAMMPS_NS
