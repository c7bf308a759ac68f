// SPDX-License-Identifier: GPL-2.0-only
// bond_style mdanim/harmonic: springs whose forces do not depend on the order of particles or on the number
// of ranks.

#pragma once

#include "bond.h"
#include "lammps/bond_rows.h"
#include "passes/loss.h"
#include "passes/pass_participant.h"
#include "springs/law.h"
#include "threads/team.h"

#include <vector>

namespace LAMMPS_NS {

// Keeps the springs of this rank's particles in rows, each in the order in which their forces are summed, and computes them in
// plain steps; passes get the same rows. An account is kept of the energy that dashpots beside the springs take.
class BondMdanimHarmonic : public Bond, public mdanim::PassSprings {
 public:
  explicit BondMdanimHarmonic(class LAMMPS *);
  ~BondMdanimHarmonic() override;

  void init_style() override;
  void compute(int eflag, int vflag) override;
  void coeff(int, char **) override;
  double equilibrium_distance(int) override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_data(FILE *) override;
  double single(int, double, int, int, double &) override;
  double memory_usage() override;

  void take(mdanim::SpringRows &&upper_rows);    // see BondRows

  void change_bonds() { bonds_are_changed = true; }    // some fix has: rows are made anew before the next forces
  const std::vector<mdanim::Spring> &springs() const { return spring; }    // by bond type
  bool are_given() const { return rows.are_given(); }
  double wall_seconds() const { return seconds; }    // of this rank, as the next
  double lost() const { return loss.total(); }       // to dashpots

  bool halves(mdanim::HalfBonds &half) const override;
  const std::vector<mdanim::SpringCoeffs> &coeffs() const override { return law; }
  mdanim::Loss *account() override { return damped ? &loss : nullptr; }
  long long version() const override { return made; }
  bool refresh_coefficients() override;
  [[noreturn]] void lost_partner(int i, int partner) const override { rows.lost_partner(i, partner); }
  void took(double more) override { seconds += more; }
  void equip(const mdanim::Kernels &, const mdanim::Threads &now) override { threads = now; }

 private:
  void allocate();
  void refuse_if_given();
  bool has_dashpots() const;
  template <class Visit> void each_spring(Visit visit) const;    // visit(i, j, type, r_ij)
  void tally();

  std::vector<mdanim::Spring> spring;       // by bond type
  std::vector<mdanim::SpringCoeffs> law;    // by bond type
  bool damped = false;                      // some spring has a dashpot
  bool coefficients_may_differ = false;     // since their laws were made
  bool bonds_are_swapped = false;           // some fix changes partners during a run
  bool bonds_are_changed = false;           // since rows were made
  mdanim::BondRows rows;
  bigint made = 0;           // version of rows and coefficients
  bigint made_after = -1;    // number of the lists that they were made after
  mdanim::Threads threads;

  mdanim::Loss loss;    // to dashpots, on this rank
  double seconds = 0.0;
};

}    // namespace LAMMPS_NS
