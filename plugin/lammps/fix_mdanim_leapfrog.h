// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/leapfrog: advances particles by the leap-frog with friction. Wcislo 1999, eq. (3.12).

#pragma once

#include "geometry/boxes.h"
#include "lammps/fix_base.h"
#include "passes/pass_participant.h"
#include "threads/team.h"

#include <algorithm>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Moves particles by the half steps of leapfrog/law.h in plain steps, and gives passes their coefficients. Keeps the account of
// friction, the kinetic energy that fits the other energies to fourth order, and the trace: the box in which each object has
// been.
class FixMdanimLeapfrog : public mdanim::FixBase, public mdanim::PassIntegrator {
 public:
  FixMdanimLeapfrog(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup(int) override;
  void reset_dt() override;
  void initial_integrate(int) override;
  void final_integrate() override;
  double compute_scalar() override;
  void write_restart(FILE *) override;
  void restart(char *) override;

  // For trace_c.cpp, all ranks together: starts the trace of each object, molecule 1 to M, its present place included. Returns an
  // empty string, or why there can be no trace.
  std::string start_trace(int objects);
  // From now on passes look at particles only after this number of passes; boxes are wider by the way that the fastest particle
  // may have gone meanwhile.
  void look_every(int passes) { look_after = passes; }
  int traced() const { return static_cast<int>(trace.size()); }    // objects; 0 when off
  std::vector<mdanim::Box> traced_boxes() const;

  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;

  std::vector<Known> survey_ghosts(std::vector<int> &sent) override;
  mdanim::Friction friction() const override;
  mdanim::Mover mover(int i) override;
  double *trace_rows() override { return trace.empty() ? nullptr : trace.front().box.bound; }
  bool looks() override;
  void finish_step(const std::vector<int> &particles) override;
  void begin_step(const std::vector<int> &particles) override;
  bool tells_of(long long step) const override;
  void equip(const mdanim::Kernels &, const mdanim::Threads &now) override { threads = now; }
  void moved(double loss, double bend, double phi, double more_seconds) override;
  const double *friction_of_particles() const override { return has_drag ? lambda.values(lmp) : nullptr; }

 private:
  // Sums over the particles of a loop.
  struct Sums {
    double loss = 0.0, bend = 0.0, kinetic = 0.0, swing = 0.0, largest_phi = 0.0;

    void add(const Sums &more)
    {
      loss += more.loss;
      bend += more.bend;
      kinetic += more.kinetic;
      swing += more.swing;
      largest_phi = std::max(largest_phi, more.largest_phi);
    }
  };
  template <class Visit> Sums each(Visit visit) const;
  template <bool FIRST> void half_step();
  template <bool FIRST, class Drag> void half_step_with_drag();
  void drift();
  void drift_and_trace();
  double largest_phi_here() const;
  double bend() const;
  double kinetic();

  bool has_drag = false, exponential = false;
  mdanim::ParticleValue lambda;
  double half_dt = 0.0;                      // dt/2 in units that turn force/mass into velocity
  double lost = 0.0;                         // energy taken by drag on this rank
  bool told = false;                         // whether kinetic() may be asked for in this step
  double bent = 0.0;                         // dt v^{n-1/2} . (F^n - F^{n-1}) on this rank, if `told`
  double largest_phi = 0.0;                  // largest on this rank in this run
  const std::vector<int> *only = nullptr;    // particles to move now; null for all
  std::vector<int> sent;                     // while ghosts are surveyed
  std::vector<Known> known;
  struct Way {
    mdanim::Box box;
    double fastest = 0.0;    // negative of the largest v^2 in passes that may not have looked
  };
  Way &way_of(int i);
  std::vector<Way> trace;    // for the objects of this rank's particles; empty when off
  int look_after = 1;        // passes from one look to the next
  int not_seen = 0;          // passes since the last look
  mdanim::Threads threads;
};

}    // namespace LAMMPS_NS
