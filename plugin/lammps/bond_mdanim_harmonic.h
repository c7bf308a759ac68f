// SPDX-License-Identifier: GPL-2.0-only
// bond_style mdanim/harmonic: springs whose forces do not depend on the order of particles or on the number
// of ranks.

#pragma once

#include "bond.h"
#include "numbers/vec3.h"
#include "passes/loss.h"
#include "passes/pass_participant.h"
#include "simd/kernels.h"
#include "springs/law.h"
#include "springs/spring_kernels.h"
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
  void *extract(const char *, int &) override;

  // Uses only these springs from now on, whatever bonds particles have: the springs of all particles, in the order of their tags,
  // on a rank that is alone.
  void take(mdanim::SpringRows &&upper_rows);

  const std::vector<mdanim::Spring> &springs() const { return spring; }    // by bond type
  bool are_given() const { return given; }

  bool halves(mdanim::HalfBonds &half) const override;
  const std::vector<mdanim::SpringCoeffs> &coeffs() const override { return law; }
  mdanim::Loss *account() override { return damped ? &loss : nullptr; }
  long long version() const override { return made; }
  bool refresh_coefficients() override;
  [[noreturn]] void lost_partner(int i, int partner) const override;
  void took(double more) override { seconds += more; }
  void equip(const mdanim::Kernels &, const mdanim::Threads &now) override { threads = now; }

 private:
  // Data that the rows were made from, besides the bonds themselves, which they hold. Rows are kept while all of it is unchanged.
  struct Source {
    std::vector<tagint> tag;
    std::vector<int> count;    // of bonds
  };
  using Row = mdanim::SpringRows::Row;
  // The bonds of a few rows, one array per quantity, for the vector units.
  struct Stretch {
    std::vector<double> x, y, z;       // r_ij, then F_i
    std::vector<double> push, pull;    // see SpringCoeffs
    std::vector<double> K, r0;         // of energies, see Spring
  };
  // Forces that particles have received from lower partners so far, for sum_halves(): those from the present row to its farthest
  // partner, in a ring of 2^n places.
  struct Ring {
    std::vector<mdanim::Vec3> force;
    int mask;    // 2^n - 1

    explicit Ring(int farthest);
    mdanim::Vec3 &of(int i) { return force[i & mask]; }
  };
  // Memory that a thread needs besides the rows.
  struct Workspace {
    Stretch stretch;
    Ring received;
    explicit Workspace(int farthest) : received(farthest) {}
  };

  void allocate();
  void refuse_if_given();
  bool source_changed();
  void make_rows();
  void adopt(mdanim::SpringRows &&made_rows, bool halves);
  void look_up(int i, bool halves, Row &row) const;
  bool has_changed(int i, Row &scratch) const;
  bool has_dashpots() const;
  bool halves_suffice() const;
  void take_apart(int begin, int end, int n, Stretch &stretch) const;
  void energies(int begin, int end, int n, Stretch &stretch, double &sum) const;
  void sum_rows(int begin, int end, const Stretch &stretch) const;
  void sum_halves(int begin, int end, int first, const Stretch &stretch, Ring &received) const;
  void dashpots(int begin, int end, Stretch &stretch, std::vector<mdanim::Vec3> &on) const;
  double compute_rows(int begin, int end, int first, std::vector<mdanim::Vec3> *on, Workspace &with) const;
  template <class Visit> void each_spring(Visit visit) const;    // visit(i, j, type, r_ij)
  void tally();

  const mdanim::Kernels &kernels;
  std::vector<mdanim::Spring> spring;       // by bond type
  std::vector<mdanim::SpringCoeffs> law;    // by bond type
  bool damped = false;                      // some spring has a dashpot
  bool coefficients_may_differ = false;     // since their laws were made
  bool bonds_are_swapped = false;           // some fix changes partners during a run
  mdanim::SpringRows rows;                  // of local particles, to local ones and ghosts
  bool upper_only = false;                  // only partners of a higher tag, see sum_halves()
  bool given = false;                       // by take(), not by the particles
  bigint made = 0;                          // version of the rows
  bigint made_after = -1;                   // number of the lists that they were made after
  Source source;
  int farthest = 0;    // partner of a row, where rows are halves
  std::vector<double> energy_of_chunk;
  mdanim::Threads threads;

  mdanim::Loss loss;    // to dashpots, on this rank
  double lost = 0.0;    // when it was last asked for
  double seconds = 0.0;
};

}    // namespace LAMMPS_NS
