// SPDX-License-Identifier: GPL-2.0-only
// One step of all particles, block by block: the interface to the vector code (pass_kernel.h). Plain data only; simd/of_set.h
// says why.

#pragma once

#include "buoyancy/immersed.h"
#include "passes/plane_rows.h"
#include "springs/dashpot_work.h"

namespace mdanim {

// Springs from the particles of a block to those `offset` places farther on.
struct Entry {
  int offset;
  unsigned law;    // row of Pass::law, or Pass::damped_law if the block is damped
};

// Particles that stand side by side, one in each lane of the vector unit. Springs of a block are the entries behind the previous
// block's end, offsets descending.
struct Block {
  int start;
  short lanes;       // lanes of its own particles; others are loaded with them but left as they are
  short strip;       // blocks of the strip that begins with it (strips.h), 0 within a strip
  bool held_back;    // other forces are added before it may move
  bool damped;       // some of its particles have dashpots
  bool bound;        // some have springs
  bool overlaps;     // most of its entries push some particles that the entry before pushes, too
  unsigned end;
  unsigned rates;        // first of its strip's rows of Pass::rate, if it is damped
  int external_force;    // first of its rows of Pass::external_force; negative for none
  int planes;            // first of its rows of PlaneRows; negative for none
  unsigned motion;       // row of Pass::motion
  int object;            // molecule - 1
  int chunk;             // row of Pass::sums
  int immersed;          // row of Pass::immersed; negative where no particle is near a liquid
  bool only_lifted;      // of the numbers in that row MORE alone is not 0 in some lane (InWaves::only_lifts)
  bool at_border;        // of a range of blocks: some of what is loaded for it belongs to another range
  int crossing;          // its row of Pass::crossed; negative where none of its springs crosses the border above it
};

// Blocks of a strip at most (docs/decisions/one-pass.md).
constexpr int LONGEST_STRIP = 16;

// The springs of a block that cross a border between two ranges of blocks: entries behind the previous crossing's end.
struct Crossing {
  int start;
  bool damped;
  unsigned end;
  unsigned rates;
};

// A border between two ranges. Springs across it are evaluated once, before a thread moves any particle that they need. They are
// the first that their lower particles add up, as their offsets are the longest. They are the first that their upper particles
// receive, as these come from their lowest partners. So each sum keeps the order that it has without a border.
struct Border {
  int first, crossings;    // of Pass::crossing, ascending
  unsigned first_entry;
  double *f[3];                 // of the range above
  unsigned claimed, crossed;    // Pass::turn in which a thread has begun to evaluate them, and in which they are done
};

// Blocks that one thread takes through a pass.
struct Range {
  int first, blocks;    // of Pass::block
  unsigned first_entry;
  int end;                  // particle
  Border *below, *above;    // null where no spring crosses
  double *f[3];             // of this range alone, with the lanes of a vector on either side
  int shared[2];            // objects that the ranges below and above may have blocks of, too; negative for none
  double *shared_trace;     // two rows of TRACE for them
};

enum class Friction { NONE, IMPLICIT, EXPONENTIAL };

// A row of Pass::motion, one number for each lane.
enum Motion { MASS, KICK, DT, FOREIGN_LANE, OWNED_LANE, STAY, SHARE, PUSH, BRAKED_MASS, PHI, MOTIONS };
// MASS: mass that gravity pulls at; KICK: dt/2m; DT: time step, 0 for particles that do not move; FOREIGN_LANE: 1 in a lane that
// is not the block's own; OWNED_LANE: 1 for a particle of this rank. With friction also, see leapfrog/law.h: STAY: 1 - phi or e;
// SHARE: 1 / (1 + phi); PUSH: g dt/2m; BRAKED_MASS: m, 0 without friction; PHI.

// Values that a particle's motion depends on.
struct Mover {
  double pulled;                 // mass that gravity pulls at
  double mass, kick, dt, phi;    // see Motion
  bool in_liquid;                // its friction is in Pass::immersed
};

// A row of Pass::trace: a box, see boxes.h, and the negative of the largest v^2.
enum Trace { FASTEST = 6, TRACE };

using DashpotSums = DashpotWork<double>;    // over springs

// Sums over particles that have moved in a pass. They are kept for each chunk of particles (Cut) and added up in the order of
// chunks: no number depends on how many lanes a block has, nor on which threads take the pass.
struct PassSums {
  double loss;      // to friction
  double bend;      // dt v^{n+1/2} . F^n
  double pulled;    // m v^{n-1/2} . `pull`
  DashpotSums dashpots;
  double liquid_work, liquid_lost;    // power of the liquid's forces but friction's; what its friction takes
};

// Rows of blocks that a liquid acts on, one number for each lane.
enum Impulse { IMPULSE_X = EXACT_NUMBERS, IMPULSE_Y, KEPT_NUMBERS };
struct ImmersedRows {
  double *kept;                 // rows of KEPT_NUMBERS, the exact ones and the impulses of particles on the liquid
  const float *small;           // rows of SMALL_NUMBERS
  const double *particle;       // rows of PARTICLE_NUMBERS,
  const unsigned *particles;    // and which of them goes with a row of the others
  LiquidScales liquid;
  double top_of_near;    // below it the speed of what is LISTED counts
};

struct PassAcceleration {
  double now[3];     // [velocity/time]
  double both[3];    // the sum of this one and that of the last step,
  bool works;        // if its work is asked for
};

struct Pass {
  const Block *block;
  const Entry *entry;
  const double *law;           // rows of push and pull (spring.h), one of each for every lane
  const double *damped_law;    // rows of push, pull and c; null where nothing is damped
  const double *motion;        // see Motion
  double *x[3], *v[3];         // x^n -> x^{n+1}, v^{n-1/2} -> v^{n+1/2}
  double dt;
  // With dashpots: strain rates in the forces of the last step, one for each lane of an entry, those of a strip entry by entry;
  // and the velocities that the forces of this step were computed with, v^{n-3/2} -> v^{n-1/2}, of blocks that are not held back.
  float *rate;
  double *seen[3];
  const Range *range;    // the range; forces from lower partners so far are zero before and after a pass
  const Crossing *crossing;
  const Entry *crossing_entry;
  double *crossed;    // what crossing springs do to their lower particles: rows of (3, lanes), (5, lanes) with dashpots
  unsigned turn;      // number of the pass
  PassAcceleration gravity;
  double *external_force;    // rows of forces from elsewhere, (3, lanes) each, to be added after gravity; zero after a pass:
  int force_providers;       // so many in a row for a block that has any
  PlaneRows planes;          // forces that are added to those of the same provider
  Friction friction;
  ImmersedRows immersed;
  double *total;     // (N, 3): sum of all forces on the particles of blocks that are held back
  double *trace;     // rows of TRACE, one of each object: to be grown; null for none
  bool looks;        // where particles are after this pass; else the trace takes note of their speeds alone
  bool bends;        // `bend` is asked for
  PassSums *sums;    // of every chunk, zero before a pass

  double fastest;         // largest v^2 of what has moved
  double squares;         // sum of v^2, with lanes of others: finite where all of them are
  double fastest_near;    // largest v^2 of what is near the liquid, -1 for nothing
  double largest_phi;     // of what is near the liquid
};

}    // namespace mdanim
