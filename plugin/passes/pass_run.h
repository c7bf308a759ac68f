// SPDX-License-Identifier: GPL-2.0-only
// Steps taken by passes, from the first to the last before LAMMPS's arrays must be up to date again.

#pragma once

#include "passes/pass_participant.h"
#include "passes/simd_blocks.h"
#include "simd/kernels.h"
#include "threads/team.h"

#include <functional>
#include <vector>

namespace mdanim {

// The arrays of the host program: positions, velocities and forces, by particle.
struct AtomArrays {
  double *const *x, *const *v, *const *f;
};

// A run of passes over blocks that are laid out: from its beginning to leave() positions and velocities are in the blocks. It
// asks the members of the crew for motion, forces and accounts, in the order in which the plain step adds forces.
class PassRun {
 public:
  // Data that must be given to the blocks again: none where they have left the last run and nothing has changed since.
  struct Fresh {
    bool positions, motion;
  };
  PassRun(SimdBlocks &blocks, const Kernels &kernels, const Threads &threads, const PassCrew &crew, const AtomArrays &atoms,
          double dt, Fresh fresh);

  // Whether a participant reads particles in the arrays, besides those that are held back.
  bool participants_look() const { return look; }
  // Takes one pass, to step `next`. Participants that come after it act by `late`: first for their forces, then, with true, at
  // the end of the step.
  void step(long long next, const std::function<void(bool at_end)> &late);
  // The largest speed in the last step.
  double largest_speed() const;
  bool in_range() const { return pass.squares < LARGEST_SQUARE; }
  static bool in_range(const AtomArrays &atoms, int particles);

  void leave();                                          // positions, velocities and accounts out of the blocks
  long long held_back() const { return moved_alone; }    // particles, all passes together

 private:
  // Sum of the squares of velocities (and positions) beyond which the product of a lane without a spring and zero may not be
  // zero: such a lane may hold a particle of another object. The plain step has no such lanes.
  static constexpr double LARGEST_SQUARE = 1e200;

  void set_gravity();
  double pulled_at_held_back();
  void hold_back();
  void give_back_to_liquid();
  void update_liquid();
  void take_pass();
  void early_participants_turn();
  void late_participants_turn(const std::function<void(bool at_end)> &late);

  SimdBlocks &blocks;
  const Kernels &kernels;
  const Threads &threads;
  const PassCrew &crew;
  const AtomArrays atoms;
  const double dt;
  const double ns;    // that one thread takes for a pass, before it is shared
  Pass pass = {};
  std::vector<Pass> of_range;          // the pass of each range
  PassSums sums = {};                  // sums of the last pass,
  std::vector<PassSums> chunk_sums;    // and of each of its chunks
  double phi_of_movers = 0.0;          // the largest one that members told of
  bool look = false;
  long long moved_alone = 0;
  PlaneBlocks::OfProviders at_planes;       // points of early participants whose contacts the passes compute,
  std::vector<double> seconds_at_planes;    // and the time for them
  Positions place;                          // positions of the particles of an early participant
  std::vector<double> rests;                // how far particles may still go before each of these is asked for forces again
  std::vector<int> wanted;                  // particles that late participants need
};

}    // namespace mdanim
