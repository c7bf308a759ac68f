// SPDX-License-Identifier: GPL-2.0-only
// What all fixes of this package have in common: how they live in LAMMPS is dealt with once, here.

#ifndef MDANIM_FIX_BASE_H
#define MDANIM_FIX_BASE_H

#include "fix.h"
#include "lammps/named_group.h"
#include "lammps/particle_value.h"

#include <functional>
#include <string>
#include <vector>

namespace mdanim {

// What a fix needs of the run, the box and the particles, besides run_style verlet: some of these, joined by |.
enum Need : unsigned {
  THREE_DIMENSIONS = 1,
  ORTHOGONAL_BOX = 2,
  OPEN_BOX = 4,    // no periodic side
  OBJECTS = 8,     // molecule IDs
  ATOM_MAP = 16,
  PROMPT_LISTS = 32    // lists are rebuilt as soon as a particle has moved by half the skin
};

// A number that a fix tells: an entry of its vector.
struct Output {
  std::string name;
  bool extensive;
  std::function<double()> value;    // all ranks together
};

// A fix with an energy as its scalar. A fix that derives from it says in its constructor what it needs, what it looks up by name
// and which numbers it tells; init() of the base comes first in its own.
class FixBase : public LAMMPS_NS::Fix {
 public:
  FixBase(LAMMPS_NS::LAMMPS *lmp, int narg, char **arg);

  // Refuses a run that the fix cannot be in, and looks up again what LAMMPS may have moved, deleted or made anew since the last
  // one.
  void init() override;
  double compute_vector(int n) final { return numbers[n].value(); }
  const std::vector<Output> &outputs() const { return numbers; }

 protected:
  std::string name() const;    // begins messages
  // `missed`: what may happen between two rebuilds of lists, where those are to be prompt.
  void need(unsigned needs, const std::string &missed = "");
  // Members of the fix, which may be given, or given anew by fix_modify, at any time.
  void look_up(std::vector<NamedGroup *> groups, std::vector<ParticleValue *> values);
  void tell(std::vector<Output> outputs);

  // Over ranks.
  double sum(double here) const;
  double largest(double here) const;
  double least(double here) const;
  // The clock of the fix, wall seconds of this rank, as the last output.
  Output clock();
  double seconds = 0.0;

 private:
  unsigned needs = 0;
  std::string missed;
  std::vector<NamedGroup *> groups;
  std::vector<ParticleValue *> values;
  std::vector<Output> numbers;
  std::vector<int> extensive;    // of numbers, as LAMMPS has it
};

}    // namespace mdanim

#endif
