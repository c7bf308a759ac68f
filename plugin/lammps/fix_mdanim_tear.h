// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/tear: springs of bond_style mdanim/harmonic that are gone for good where they are stretched too far.

#pragma once

#include "lammps/fix_base.h"
#include "lammps/spring_losses.h"
#include "numbers/vec3.h"
#include "tearing/law.h"
#include "tearing/tear_rules.h"

#include <map>
#include <string>
#include <tuple>
#include <vector>

namespace LAMMPS_NS {

class BondMdanimHarmonic;
class FixMdanimYield;

// A link that is gone: the molecule ID of its object, and its ends, counted from the lowest tag of the object, 0.
struct GoneLink {
  int object, low, high;
  bool operator<(const GoneLink &other) const
  { return std::tie(object, low, high) < std::tie(other.object, other.low, other.high); }
};

// Looks at the springs of objects that may tear before the forces of each step, and takes those that break (tearing/law.h) out of
// the rows of the bond style: the type of such a bond is negative, which LAMMPS leaves out. The property `torn`, bits of each
// particle in the order of its bonds, is what it goes by: it is that of the particles' records, and a run begins with it. Adds
// the forces of what remains of springs over two links, whose energy is its scalar.
class FixMdanimTear : public mdanim::FixBase {
 public:
  FixMdanimTear(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup_post_neighbor() override;
  void post_neighbor() override;
  void setup(int) override { pull(); }
  void pre_force(int) override;
  void final_integrate() override;
  void post_force(int) override;
  double compute_scalar() override;
  double memory_usage() override;

  // Links that are gone, the same on all ranks: those before a run, ascending, then those of each step.
  const std::vector<GoneLink> &gone() const { return gone_links; }
  // The fix of this style that there is; null for none.
  static const FixMdanimTear *of(LAMMPS *lmp);

 private:
  // A bond of a local particle to one here that may break, and the square of its length from which on it does.
  struct Watched {
    int i, j;
    double square;
  };
  // A spring over two links with an end or the middle here: indices, the slot of the spring at both ends, and which of its links
  // are gone.
  struct Spanning {
    const mdanim::TearOver *over;
    bool leaves_rest;
    int at[3], slot[2];
    bool gone[2];
  };
  static constexpr int WORD = 31;    // bits of a number

  void find_objects();
  void take_state();
  void watch();
  void watch_bonds(int i, const mdanim::TearRules &rules, tagint lowest);
  void span(const mdanim::TearRules &rules, tagint lowest);
  void find_gone(Spanning &one, const tagint (&tag)[3]) const;
  int number(int i) const;    // of the object of a particle among those of the rules; -1 for none
  void find_bits();
  int *bits(int i) const { return has_one ? one_number() + i : numbers()[i]; }
  bool is_gone(int i, int slot) const { return bits(i)[slot / WORD] >> (slot % WORD) & 1; }
  void let_go(int i, int slot);
  void break_link(const Watched &one, std::vector<GoneLink> &here);
  int slot_of(int i, tagint partner) const;
  bool is_here(int i) const;
  void release(int i, int j, const mdanim::LoadFree &spring, double sign);
  void release(const Spanning &one, double sign);
  mdanim::LoadFree load_free(const Watched &one) const;
  mdanim::LoadFree grown_by(const mdanim::LoadFree &spring, int i, int slot) const;
  void tell_all(std::vector<GoneLink> here);
  template <class Visit> void each_remainder(Visit visit) const;    // visit(i, apart, LoadFree) for each local end
  void pull() const;

  int *one_number() const;
  int **numbers() const;

  std::string torn;       // name of the property
  int property = -1;      // its place among LAMMPS's
  bool has_one = true;    // number for each particle; else several
  std::map<int, mdanim::TearRules> rules;
  std::vector<tagint> lowest;    // tags of objects, in the order of the rules
  BondMdanimHarmonic *springs = nullptr;
  const FixMdanimYield *yields = nullptr;    // null where no spring yields
  std::vector<Watched> watched;
  std::vector<Spanning> spanning;
  bool any_remains = false;    // of springs over two links
  std::vector<GoneLink> gone_links;
  mdanim::SpringLosses losses;
};

}    // namespace LAMMPS_NS
