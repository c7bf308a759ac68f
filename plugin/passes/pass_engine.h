// SPDX-License-Identifier: GPL-2.0-only
// What run_style verlet/mdanim computes with, without LAMMPS and without MPI.

#ifndef MDANIM_PASS_ENGINE_H
#define MDANIM_PASS_ENGINE_H

#include "passes/pass_run.h"
#include "passes/simd_blocks.h"
#include "passes/tag_order.h"
#include "simd/kernels.h"

#include <optional>
#include <vector>

namespace mdanim {

// Owns what passes need, in the order in which each makes the next: the crew and its kernels, cuts of the springs, blocks that
// are laid out, and a run of passes. It cuts anew only what has changed.
class PassEngine {
 public:
  PassCrew crew;

  // These threads take passes. The caller of all other functions is one of them.
  void set_threads(Threads &&now) { threads = std::move(now); }

  // The crew is complete: with these kernels, and what only this run knows forgotten. Whether the kernels are others than before.
  bool begin_run(const Kernels &kernels);
  void forget_springs();    // particles may have others now

  // Blocks for the springs as they are now, of a rank that has all particles, in tag order; `object` null where there are none.
  // False where passes are not worth it.
  bool cut(int particles, const int *object);
  // Of one of several ranks, for its particles and the ghosts that they have springs to. All ranks are to decide by their uses
  // together.
  LaneUse cut(const Bonded &known);
  const TagOrder &order() const { return line; }

  // Starts a run of passes; `build` is the number of the lists, which particles keep their motion with.
  PassRun &start(const AtomArrays &atoms, double dt, bool positions, long long build);
  void keep_motion(long long build) { motion_for = build; }    // lists are new, and particles move as before
  bool is_running() const { return run.has_value(); }
  PassRun &running() { return *run; }
  void leave();                   // ends it
  void drop() { run.reset(); }    // ends one that an error has broken off, without taking anything from its blocks
  SimdBlocks &laid_out() { return *blocks; }

  long long held_back() const { return moved_alone; }    // particles, all passes together
  const char *width() const { return kernels ? kernels->name : ""; }
  int ranges() const { return blocks ? static_cast<int>(blocks->ranges().size()) : 0; }
  std::size_t bytes() const;

 private:
  static constexpr long long NONE = -1;

  RangeCut ranges_of(Cut &cut);

  Threads threads;
  const Kernels *kernels = nullptr;
  long long cut_for = NONE;            // version of the springs
  long long motion_for = NONE;         // build of lists
  std::vector<int> objects;            // of a rank that has all particles: what it is cut for
  TagOrder line;                       // of one of several: what is cut,
  std::vector<SpringCoeffs> coeffs;    // for these,
  LaneUse use;                         // and how well
  Cutter cutter;
  std::optional<SimdBlocks> blocks;
  std::optional<PassRun> run;
  long long moved_alone = 0;
};

}    // namespace mdanim

#endif
