// SPDX-License-Identifier: GPL-2.0-only
// The engine of run_style verlet/mdanim, without LAMMPS and without MPI.

#pragma once

#include "passes/pass_run.h"
#include "passes/simd_blocks.h"
#include "passes/tag_order.h"
#include "simd/kernels.h"

#include <optional>
#include <vector>

namespace mdanim {

// Owns the parts of a pass, in the order in which each makes the next: the crew and its kernels, cuts of the springs, blocks that
// are laid out, and a run of passes. It cuts anew only after a change.
class PassEngine {
 public:
  PassCrew crew;

  // Sets the threads that take passes. The caller of all other functions is one of them.
  void set_threads(Threads &&now) { threads = std::move(now); }
  // Has a style compute with these threads in steps without passes too.
  void equip(Equipped &style, const Kernels &now) const { style.equip(now, threads); }

  // The crew is complete and uses these kernels; knowledge of a single run is forgotten. Returns whether the kernels differ from
  // before.
  bool begin_run(const Kernels &kernels);
  void forget_springs();    // particles may have other springs now

  // Cuts blocks for the springs as they are now, for a rank that has all particles, in tag order; `object` is null where there
  // are none. False where passes do not pay.
  bool cut(int particles, const int *object);
  // Cuts blocks for one of several ranks: its particles and the ghosts that they have springs to. All ranks are to decide
  // together, by the lane use of all.
  LaneUse cut(const Bonded &known);
  const TagOrder &order() const { return line; }

  // Starts a run of passes. `build` is the number of the lists: while it stays the same particles keep their motion.
  PassRun &start(const AtomArrays &atoms, double dt, bool positions, long long build);
  void keep_motion(long long build) { motion_for = build; }    // lists are new, and particles move as before
  bool is_running() const { return run.has_value(); }
  PassRun &running() { return *run; }
  void leave();                   // ends the run
  void drop() { run.reset(); }    // ends a run that an error has broken off, without taking anything from its blocks
  SimdBlocks &laid_out() { return *blocks; }

  long long held_back() const { return moved_alone; }    // particles, all passes together
  const char *width() const { return kernels ? kernels->name : ""; }
  int ranges() const { return blocks ? static_cast<int>(blocks->ranges().all().size()) : 0; }
  long points_at_planes() const { return blocks ? blocks->points_at_planes() : 0; }
  std::size_t bytes() const;

 private:
  static constexpr long long NONE = -1;

  RangeCut ranges_of(Cut &cut);

  Threads threads;
  const Kernels *kernels = nullptr;
  long long cut_for = NONE;            // version of the springs
  long long motion_for = NONE;         // build of lists
  std::vector<int> objects;            // for a rank that has all particles: the objects that it is cut for
  TagOrder line;                       // for one of several ranks: the line that is cut,
  std::vector<SpringCoeffs> coeffs;    // for these coefficients,
  LaneUse use;                         // and the lane use
  Cutter cutter;
  std::optional<SimdBlocks> blocks;
  std::optional<PassRun> run;
  long long moved_alone = 0;
};

}    // namespace mdanim
