// SPDX-License-Identifier: GPL-2.0-only
// How the bond style and fixes take part in passes over blocks (pass.h), which keep positions and velocities in arrays of their
// own.

#pragma once

#include "contact/points_at_plane.h"
#include "geometry/aligned_array.h"
#include "numbers/vec3.h"
#include "passes/displacement_budget.h"
#include "passes/force_sums.h"
#include "passes/pass.h"
#include "passes/pass_liquid.h"
#include "springs/spring_rows.h"

#include <vector>

namespace mdanim {

class Loss;
struct Kernels;
class Threads;

// The owner of a particle: the rank, and the index in its arrays.
struct Home {
  int rank, index;
};

struct PassCrew;

// A style that may compute with kernels and threads, also where each step is LAMMPS's own.
class Equipped {
 public:
  // Sets those of this run.
  virtual void equip(const Kernels &, const Threads &) {}

 protected:
  ~Equipped() = default;
};

// A member of the crew of a pass: the bond style, or a fix.
class PassMember : public Equipped {
 public:
  // Joins the crew. False where it cannot, given those that have joined before: each step is then LAMMPS's own.
  virtual bool join(PassCrew &crew) = 0;

 protected:
  ~PassMember() = default;
};

// The springs of all particles, which passes compute.
class PassSprings : public PassMember {
 public:
  bool join(PassCrew &crew) final;
  virtual bool halves(HalfBonds &half) const = 0;    // the springs, each once; false where that is not how they are summed
  virtual const std::vector<SpringCoeffs> &coeffs() const = 0;    // by bond type
  virtual Loss *account() = 0;                                    // of dashpots; null where there are none, on all ranks
  virtual long long version() const = 0;                          // another number for other springs
  virtual bool refresh_coefficients() = 0;                        // whether some differ from before
  [[noreturn]] virtual void lost_partner(int i,
                                         int partner) const = 0;    // the error that particle i, or none, has this partner, a tag
  virtual void took(double seconds) = 0;
};

// The integrator: moves particles, and keeps the account of friction.
class PassIntegrator : public PassMember {
 public:
  // A particle's object, 1 where there are none, and its owner.
  struct Known {
    int object;
    Home home;
  };

  bool join(PassCrew &crew) final;
  virtual Friction friction() const = 0;
  virtual Mover mover(int i) = 0;
  virtual double *trace_rows() = 0;                                   // see Pass; null for no trace
  virtual bool looks() = 0;                                           // asked once in every pass
  virtual bool tells_of(long long step) const = 0;                    // whether `bend` will be asked for in that step
  virtual void finish_step(const std::vector<int> &particles) = 0;    // v^{n-1/2} -> v^n
  virtual void begin_step(const std::vector<int> &particles) = 0;     // v^n -> v^{n+1/2}, r^n -> r^{n+1}
  // Reports a pass that moved particles for the integrator.
  virtual void moved(double loss, double bend, double largest_phi, double seconds) = 0;
  // Friction of particles that have values of their own, else null.
  virtual const double *friction_of_particles() const = 0;
  // Called by all ranks together, after lists were made: own particles that other ranks have as ghosts, and the object and owner
  // of all particles.
  virtual std::vector<Known> survey_ghosts(std::vector<int> &sent) = 0;
};

// m g on every particle, which passes add right after the springs.
class PassGravity : public PassMember {
 public:
  bool join(PassCrew &crew) final;
  virtual double pulled(int i) const = 0;    // the mass that it pulls at
  virtual bool steady() const = 0;           // whether the acceleration is the same in all steps
  virtual const Vec3 &acceleration() const = 0;
  // Unless it is: called once in each step, sets the acceleration and returns the sum of this one and that of the last step.
  virtual Vec3 turn_to_step() = 0;
  // Then reports what that sum does, times the sum of m v^{n-1/2} of this rank's particles.
  virtual void worked(double power) = 0;
  virtual void took(double seconds) = 0;
};

// A fix whose forces run_style verlet/mdanim can combine with passes. It names the particles that it needs, tells whether
// positions are all that its forces depend on, and how far particles may go before it needs new lists.
class PassParticipant : public PassMember {
 public:
  bool join(PassCrew &crew) override;
  // Appends the local particles whose x, v and f the fix reads or writes in post_force() and end_of_step(), until lists are
  // rebuilt. The arrays of LAMMPS hold no others. A particle may be appended twice.
  virtual void append_required_atoms(std::vector<int> &particles) const = 0;
  // Whether, in this whole run, the fix only adds forces that depend on the positions of these particles, each of which is named
  // once. It may then be asked for the forces before the pass, which adds them: one for each particle that
  // append_required_atoms() names, in that order; those of ghosts are ignored.
  virtual bool depends_on_positions_only() const { return false; }
  virtual void add_forces(const Positions & /*place*/, const ForceSums & /*force*/) {}
  // How far particles may go, from where they were when it was asked for forces last, before it adds some again.
  virtual double rests_for() const { return 0.0; }
  // Hands over points of such a fix at planes, whose contacts passes are to compute and to add up, in the order in which planes
  // act: beside these the fix gives no forces and needs no particles. Empty where it does all itself. They belong to passes until
  // they are taken back, with the wall time that passes took for them since.
  virtual std::vector<PointsAtPlane> hand_over_planes() { return {}; }
  virtual void take_back_planes(const std::vector<PointsAtPlane> & /*planes*/, double /*seconds*/) {}
  // Whether it will read any particle in this step. Asked once, when the step has begun, unless the fix needs positions only.
  virtual bool needs_all_atoms() { return false; }
  // How far particles may go from where they were at the last rebuild before the fix must look again, as far as it can tell. A
  // fix that has nothing to do until then says so here, and lists last longer than half the skin.
  virtual double safe_displacement() const { return 0.0; }
  // Whether a motion that all particles share counts. It does not for a fix that depends on distances between particles only.
  virtual bool sees_absolute_position() const { return true; }

 protected:
  ~PassParticipant() = default;
};

// All members that act in a step, in the order in which LAMMPS has them: participants whose forces are asked for before a pass,
// and those that come after it.
struct PassCrew {
  PassSprings *springs = nullptr;
  PassIntegrator *integrator = nullptr;
  PassGravity *gravity = nullptr;
  PassLiquid *liquid = nullptr;    // a late participant too
  std::vector<PassParticipant *> early, late;

  void equip(const Kernels &kernels, const Threads &threads) const;
  // How far particles may go before some participant must look again, `any` at most.
  SafeDisplacement safe_displacement(double any) const;
};

inline void PassCrew::equip(const Kernels &kernels, const Threads &threads) const
{
  springs->equip(kernels, threads);
  integrator->equip(kernels, threads);
  for (const auto *participants : {&early, &late})
    for (PassParticipant *p : *participants) p->equip(kernels, threads);
}

inline SafeDisplacement PassCrew::safe_displacement(double any) const
{
  SafeDisplacement safe = {any, any};
  for (const auto *participants : {&early, &late})
    for (const PassParticipant *p : *participants) {
      double &least = p->sees_absolute_position() ? safe.absolute : safe.relative;
      least = std::min(least, p->safe_displacement());
    }
  return safe;
}

inline bool PassSprings::join(PassCrew &crew)
{
  if (crew.springs) return false;
  crew.springs = this;
  return true;
}

inline bool PassIntegrator::join(PassCrew &crew)
{
  if (crew.integrator) return false;
  crew.integrator = this;
  return true;
}

// Its force comes before those of participants.
inline bool PassGravity::join(PassCrew &crew)
{
  if (crew.gravity || !crew.early.empty() || !crew.late.empty()) return false;
  crew.gravity = this;
  return true;
}

// A participant after a late one is late itself: forces are added in the order of fixes.
inline bool PassParticipant::join(PassCrew &crew)
{
  (depends_on_positions_only() && crew.late.empty() ? crew.early : crew.late).push_back(this);
  return true;
}

}    // namespace mdanim
