// SPDX-License-Identifier: GPL-2.0-only
// The common base of all fixes of this package: their interface to LAMMPS is dealt with once, here.

#pragma once

#include "fix.h"
#include "lammps/named_group.h"
#include "lammps/particle_value.h"

#include <functional>
#include <mpi.h>
#include <string>
#include <vector>

namespace mdanim {

// Requirements of a fix on the run, the box and the particles, besides run_style verlet: some of these, joined by |.
enum Need : unsigned {
  THREE_DIMENSIONS = 1,
  ORTHOGONAL_BOX = 2,
  OPEN_BOX = 4,    // no periodic side
  OBJECTS = 8,     // molecule IDs
  ATOM_MAP = 16,
  PROMPT_LISTS = 32    // lists are rebuilt as soon as a particle has moved by half the skin
};

// A number that a fix outputs: an entry of its vector.
struct Output {
  std::string name;
  bool extensive;
  std::function<double()> value;    // all ranks together
};

// A fix with an energy as its scalar. The constructor of a derived fix declares its needs, the members to look up by name and its
// outputs; its init() calls init() of the base first.
class FixBase : public LAMMPS_NS::Fix {
 public:
  FixBase(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg);

  // Refuses a run that the fix cannot work in, and looks up again the members that LAMMPS may have moved, deleted or made anew
  // since the last run.
  void init() override;
  double compute_vector(int n) final { return numbers[n].value(); }
  const std::vector<Output> &outputs() const { return numbers; }

 protected:
  std::string name() const;         // begins messages
  bool lists_are_prompt() const;    // see PROMPT_LISTS
  // `missed`: events that would be missed between two rebuilds of lists, where those must be prompt.
  void need(unsigned needs, const std::string &missed = "");
  // Members to look up, which may be set, by fix_modify as well, at any time.
  void look_up(std::vector<NamedGroup *> groups, std::vector<ParticleValue *> values);
  void tell(std::vector<Output> outputs);

  // Values of all ranks together.
  double sum(double here) const { return reduced(here, MPI_SUM); }
  double largest(double here) const { return reduced(here, MPI_MAX); }
  double least(double here) const { return reduced(here, MPI_MIN); }
  // The clock of the fix, wall seconds of this rank, as the last output.
  Output clock();
  double seconds = 0.0;

 private:
  double reduced(double here, MPI_Op operation) const;

  unsigned needs = 0;
  std::string missed;
  std::vector<NamedGroup *> groups;
  std::vector<ParticleValue *> values;
  std::vector<Output> numbers;
  std::vector<int> extensive;    // of numbers, as LAMMPS has it
};

}    // namespace mdanim
