// SPDX-License-Identifier: GPL-2.0-only
// One step of all particles, block by block: what the vector code (pass_kernel.h) is given. Plain data alone, for the reason told
// in kernels_of_set.cpp.

#ifndef MDANIM_PASS_H
#define MDANIM_PASS_H

#include "laws/dashpot_work.h"

namespace mdanim {

// Springs from the particles of a block to those `offset` places further on.
struct Entry {
  int offset;
  unsigned law;    // row of Pass::law, or Pass::damped_law if the block is damped
};

// Particles that stand side by side, one to each lane of the vector unit. Its springs are the entries from the last block's end
// on, offsets descending.
struct Block {
  int start;
  short lanes;       // of its own; what else is loaded with them belongs to others and is left as it is
  bool held_back;    // others add to its forces before it may move
  bool damped;       // some of its particles have dashpots
  bool bound;        // some have springs
  unsigned end;
  int external_force;    // first of its rows of Pass::external_force; negative for none
  unsigned motion;       // row of Pass::motion
  int object;            // molecule - 1
};

enum class Friction { NONE, IMPLICIT, EXPONENTIAL };

// A row of Pass::motion, one number for each lane.
enum Motion { MASS, KICK, DT, FOREIGN_LANE, OWNED_LANE, STAY, SHARE, PUSH, BRAKED_MASS, PHI, MOTIONS };
// MASS what gravity pulls at; KICK dt/2m; DT the time step, 0 for what does not move; FOREIGN_LANE 1 where a lane is not the
// block's own; OWNED_LANE 1 for a particle of this rank. With friction also, see leapfrog.h: STAY 1 - phi or e; SHARE 1 / (1 +
// phi); PUSH g dt/2m; BRAKED_MASS m, 0 where there is none; PHI.

// What a particle's motion depends on.
struct Mover {
  double pulled;                 // mass that gravity pulls at
  double mass, kick, dt, phi;    // see Motion
};

// A row of Pass::trace: a box, see boxes.h, and the largest v^2 with its sign changed.
enum Trace { FASTEST = 6, TRACE };

using DashpotSums = DashpotWork<double>;    // over particles

struct Pass {
  const Block *block;
  int blocks;
  const Entry *entry;
  const double *law;           // rows of push and pull (spring.h), one of each for every lane
  const double *damped_law;    // rows of push, pull and c; null where nothing is damped
  const double *motion;        // see Motion
  double *x[3], *v[3];         // x^n -> x^{n+1}, v^{n-1/2} -> v^{n+1/2}
  double *f[3];                // what lower partners have done so far; nothing before and after a pass
  // With dashpots: their part of f; their forces of the last step, F^{n-1} -> F^n, and the velocities that those of this step
  // have seen, v^{n-3/2} -> v^{n-1/2}. Of what is held back F^n stays in `part`, and the other two as they are.
  double *part[3], *last[3], *seen[3];
  double gravity[3];               // [velocity/time]
  const double *external_force;    // rows of forces from elsewhere, (3, lanes) each, to be added after gravity:
  int force_providers;             // so many in a row for a block that has any
  Friction friction;
  double *total;    // (N, 3): sum of all forces on the particles of blocks that are held back
  double *trace;    // rows of TRACE, one of each object: to be grown; null for none
  bool looks;       // where particles are after this pass; else the trace takes note of their speeds alone
  bool bends;       // `bend` is asked for

  double fastest;                   // largest v^2 of what has moved
  double squares;                   // sum of v^2, with lanes of others: finite where all of them are
  double final_loss, first_loss;    // to friction in either half step
  DashpotSums dashpots;             // but for what is held back
  double bend;                      // dt v^{n+1/2} . F^n of what has moved
};

}    // namespace mdanim

#endif
