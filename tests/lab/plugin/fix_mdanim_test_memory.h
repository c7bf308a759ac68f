// SPDX-License-Identifier: GPL-2.0-only
// fix ID group mdanim/test/memory REACH K_PAIR K_OWN: forces that depend on history, for tests of how the state of fixes is kept,
// handed on and taken up. A record that is lost, or taken up for another object, changes the bits of what follows.
//
// Each particle remembers the way d that it has gone, summed up step by step, and is pulled back by -K_OWN d. Each two objects
// whose boxes are nearer than REACH remember for how many steps they have been; as long as they are, their particles are pushed
// along x by K_PAIR for each of these steps, those of the object with the lower ID to lower x.

#pragma once

#include "fix.h"
#include "lammps/stateful.h"

#include <cstdint>
#include <map>

namespace LAMMPS_NS {

class FixMdanimTestMemory : public Fix, public mdanim::Stateful {
 public:
  FixMdanimTestMemory(class LAMMPS *, int, char **);
  ~FixMdanimTestMemory() override;

  int setmask() override;
  void setup(int) override;
  void post_force(int) override;
  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  mdanim::StateRecords pack() const override;
  void unpack(const mdanim::StateRecords &records) override;

 private:
  void remember();
  void push();

  double reach, k_pair, k_own;
  double **way = nullptr;                            // of each particle
  std::map<mdanim::StateKey, std::int64_t> steps;    // that two objects have been near each other
};

}    // namespace LAMMPS_NS
