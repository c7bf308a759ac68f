// SPDX-License-Identifier: GPL-2.0-only
// The pass over all blocks (pass.h), for vectors of LANES doubles; compiled once for each kind of processor (pass_*.cpp).
//
// Springs are evaluated once. Blocks come in ascending order and in each of them offsets in descending order, so that whoever
// receives does so from its lower partners in ascending order, and a block's own sum takes its upper ones in descending order:
// the order of bond_mdanim_harmonic.cpp, hence its bits. Lanes without a spring have push = pull = 0 and add nothing: F = 0, and
// a sum that starts at +0 is never -0. Positions of a block can move on at once, for all that is still to come reads its own and
// upper ones.

#include "engine/pass.h"
#include "engine/vectors.h"
#include "laws/spring.h"

namespace mdanim {
namespace {

MDANIM_INLINE Vector largest(Vector a, Vector b) { return a > b ? a : b; }

MDANIM_INLINE Vector dot(const Vector *a, const Vector *b) { return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]; }

// What friction takes in a half step from va to vb: `loss` in leapfrog.h; `lag` is h, w and their shares there, and phi 0 without
// it.
MDANIM_INLINE Vector loss(const Vector *va, const Vector *vb, const Vector *push, const Vector *lag, Vector phi, Vector weight)
{
  Vector sum[3], rest[3];
  for (int d = 0; d < 3; ++d) {
    sum[d] = va[d] + vb[d];
    rest[d] = push[d] - (vb[d] - va[d]);
  }
  return weight * (dot(sum, rest) + 2.0 * (phi * dot(push, lag)));
}

// Largest and smallest coordinates of one object, as they come.
struct Bounds {
  Vector low[3], high[3];

  MDANIM_INLINE void open()
  {
    for (Vector &b : low) b = Vector{} + __DBL_MAX__;
    for (Vector &b : high) b = Vector{} - __DBL_MAX__;
  }
  MDANIM_INLINE void include(const Vector *x)
  {
    for (int d = 0; d < 3; ++d) {
      low[d] = x[d] < low[d] ? x[d] : low[d];
      high[d] = x[d] > high[d] ? x[d] : high[d];
    }
  }
  MDANIM_INLINE void close(double *box) const    // of boxes.h
  {
    for (int d = 0; d < 3; ++d)
      for (int lane = 0; lane < LANES; ++lane) {
        if (low[d][lane] < box[d]) box[d] = low[d][lane];
        if (-high[d][lane] < box[3 + d]) box[3 + d] = -high[d][lane];
      }
  }
};

// What a pass tells at its end.
struct Tally {
  Vector fastest{}, squares{};
  double final_loss = 0.0, first_loss = 0.0, bend = 0.0;
  DashpotSums dashpots = {0.0, 0.0, 0.0};
  Bounds box;
  Vector fastest_of_object{};
  int object = -1;    // whose box and speed these are

  MDANIM_INLINE void turn_to(int next, const Pass &pass)
  {
    if (object >= 0) {
      double *const row = pass.trace + TRACE * object;
      if (pass.looks) box.close(row);
      for (int lane = 0; lane < LANES; ++lane)
        if (-fastest_of_object[lane] < row[FASTEST]) row[FASTEST] = -fastest_of_object[lane];
      fastest = largest(fastest_of_object, fastest);
    }
    box.open();
    fastest_of_object = Vector{};
    object = next;
  }
};

// Springs of a block, each once, and the dashpots beside them; adds up what its own particles feel of them and of gravity, and
// behind that what they feel of dashpots alone.
template <bool DAMPED> MDANIM_INLINE void feel(const Pass &pass, const Block &block, unsigned &e, double *total)
{
  constexpr int LAW = DAMPED ? 3 : 2;
  double *const X = pass.x[0], *const Y = pass.x[1], *const Z = pass.x[2];
  double *const FX = pass.f[0], *const FY = pass.f[1], *const FZ = pass.f[2];
  const Entry *const entry = pass.entry;
  const double *const law = DAMPED ? pass.damped_law : pass.law;
  const int i = block.start;
  const Vector x = load(X + i), y = load(Y + i), z = load(Z + i);
  Vector upper_x{}, upper_y{}, upper_z{};
  Vector v[3], part[3] = {};
  if (DAMPED)
    for (int d = 0; d < 3; ++d) v[d] = load(pass.v[d] + i);
  for (; e < block.end; ++e) {
    const int j = i + entry[e].offset;
    const double *const own = law + static_cast<unsigned long>(entry[e].law) * (LAW * LANES);
    Vector dx = x - load(X + j), dy = y - load(Y + j), dz = z - load(Z + j);
    const Vector square = ((dx * dx + dy * dy) + dz * dz) + R2_FLOOR;
    const Vector factor = load(own) / root(square) - load(own + LANES);
    Vector slowing[3];
    if (DAMPED) {
      const Vector vx = v[0] - load(pass.v[0] + j), vy = v[1] - load(pass.v[1] + j), vz = v[2] - load(pass.v[2] + j);
      const Vector drag = -(load(own + 2 * LANES) * ((vx * dx + vy * dy) + vz * dz)) / square;
      slowing[0] = drag * dx, slowing[1] = drag * dy, slowing[2] = drag * dz;
    }
    dx *= factor;
    dy *= factor;
    dz *= factor;
    if (DAMPED) {
      dx += slowing[0];
      dy += slowing[1];
      dz += slowing[2];
      for (int d = 0; d < 3; ++d) {
        part[d] += slowing[d];
        store(pass.part[d] + j, load(pass.part[d] + j) - slowing[d]);
      }
    }
    upper_x += dx;
    upper_y += dy;
    upper_z += dz;
    store(FX + j, load(FX + j) - dx);
    store(FY + j, load(FY + j) - dy);
    store(FZ + j, load(FZ + j) - dz);
  }
  const double *const motion = pass.motion + static_cast<unsigned long>(block.motion) * (MOTIONS * LANES);
  const Vector mass = load(motion + MASS * LANES), others = load(motion + FOREIGN_LANE * LANES);
  const Vector upper[3] = {upper_x, upper_y, upper_z};
#pragma GCC unroll 3
  for (int d = 0; d < 3; ++d) {
    const Vector received = load(pass.f[d] + i);
    store(pass.f[d] + i, received * others);
    store(total + d * LANES, (received + upper[d]) + mass * pass.gravity[d]);
    if (DAMPED) {
      const Vector slowed = load(pass.part[d] + i);
      store(pass.part[d] + i, slowed * others);
      store(total + (3 + d) * LANES, slowed + part[d]);
    }
  }
}

// Forces of participants. Not inlined: most blocks have none, and the springs need all registers.
__attribute__((noinline)) void add_external_force(const Pass &pass, const Block &block, double *total)
{
  const double *row = pass.external_force + static_cast<long>(block.external_force) * (3 * LANES);
  for (int n = 0; n < pass.force_providers; ++n, row += 3 * LANES)
    for (int d = 0; d < 3 * LANES; d += LANES) store(total + d, load(total + d) + load(row + d));
}

// What dashpots do to the account of a block that has gone from `first` to `last`.
MDANIM_INLINE void account(const Pass &pass, const Block &block, const double *motion, const double *part, const Vector *first,
                           const Vector *last, DashpotSums &sums)
{
  const Vector others = load(motion + FOREIGN_LANE * LANES), counts = load(motion + OWNED_LANE * LANES);
  Vector work{}, bend{}, ahead{};
  for (int d = 0; d < 3; ++d) {
    double *const f = pass.last[d] + block.start, *const v = pass.seen[d] + block.start;
    const Vector now = load(part + d * LANES), before = load(f), seen = load(v);
    work += now * (first[d] + last[d]);
    bend += now * (first[d] - seen);
    ahead += before * (last[d] - first[d]);
    store(f, others > 0.0 ? before : now);
    store(v, others > 0.0 ? seen : first[d]);
  }
  double one[LANES], other[LANES], third[LANES];
  store(one, counts * work);
  store(other, counts * bend);
  store(third, counts * ahead);
  for (int lane = 0; lane < LANES; ++lane) {    // in the order of particles, whatever the width
    sums.work += one[lane];
    sums.bend += other[lane];
    sums.ahead += third[lane];
  }
}

// The second half of a step and the first of the next.
template <Friction FRICTION, bool TRACED, bool DAMPED>
MDANIM_INLINE void move(const Pass &pass, const Block &block, const double *total, Tally &tally)
{
  const int i = block.start;
  if (block.held_back) {
    for (int lane = 0; lane < block.lanes; ++lane)
      for (int d = 0; d < 3; ++d) {
        pass.total[3 * (i + lane) + d] = total[d * LANES + lane];
        if (DAMPED && block.damped) pass.part[d][i + lane] = total[(3 + d) * LANES + lane];
      }
    return;
  }
  const double *const motion = pass.motion + static_cast<unsigned long>(block.motion) * (MOTIONS * LANES);
  const Vector kick = load(motion + KICK * LANES), dt = load(motion + DT * LANES);
  Vector f[3], first[3], middle[3], last[3], place[3], square{};
#pragma GCC unroll 3
  for (int d = 0; d < 3; ++d) {
    f[d] = load(total + d * LANES);
    const Vector push = FRICTION == Friction::EXPONENTIAL ? load(motion + PUSH * LANES) * f[d] : kick * f[d];
    first[d] = load(pass.v[d] + i);
    if (FRICTION == Friction::NONE) {
      middle[d] = first[d] + push;
      last[d] = middle[d] + push;
    } else {
      const Vector stay = load(motion + STAY * LANES);
      middle[d] = FRICTION == Friction::IMPLICIT ? load(motion + SHARE * LANES) * (first[d] + push) : stay * first[d] + push;
      last[d] = stay * middle[d] + push;
    }
    store(pass.v[d] + i, last[d]);
    place[d] = load(pass.x[d] + i) + dt * last[d];
    store(pass.x[d] + i, place[d]);
    square += last[d] * last[d];
  }
  tally.squares += square;
  if (pass.bends) {
    double bend[LANES];
    store(bend, dt * dot(last, f));
    for (int lane = 0; lane < LANES; ++lane) tally.bend += bend[lane];
  }
  if (DAMPED && block.damped) account(pass, block, motion, total + 3 * LANES, first, last, tally.dashpots);
  if (FRICTION != Friction::NONE) {
    const Vector weight = load(motion + WEIGHT * LANES), phi = load(motion + PHI * LANES);
    Vector push[3], late[3], early[3];
    for (int d = 0; d < 3; ++d) {
      push[d] = kick * f[d];
      late[d] = 0.5 * middle[d] - (2.0 / 3.0) * first[d];
      early[d] = (2.0 / 3.0) * last[d] - 0.5 * middle[d];
    }
    double one[LANES], other[LANES];    // nothing in lanes of others
    store(one, loss(first, middle, push, late, phi, weight));
    store(other, loss(middle, last, push, early, phi, weight));
    for (int lane = 0; lane < LANES; ++lane) {    // in the order of particles, as the leap-frog itself
      tally.final_loss += one[lane];
      tally.first_loss += other[lane];
    }
  }
  if (TRACED) {
    if (block.object != tally.object) tally.turn_to(block.object, pass);
    if (block.lanes < LANES) {    // lanes of others go where the first one is, and rest
      const Vector others = load(motion + FOREIGN_LANE * LANES);
      for (int d = 0; d < 3; ++d) place[d] = others > 0.0 ? Vector{} + place[d][0] : place[d];
      square = others > 0.0 ? Vector{} : square;
    }
    if (pass.looks) tally.box.include(place);
    tally.fastest_of_object = largest(square, tally.fastest_of_object);
  } else {
    tally.fastest = largest(square, tally.fastest);
  }
}

// A block moves while the next one's springs keep the divider busy: nothing then waits for its forces.
template <Friction FRICTION, bool TRACED, bool DAMPED> MDANIM_INLINE void go(Pass &pass)
{
  double total[2][(DAMPED ? 6 : 3) * LANES];
  Tally tally;
  tally.box.open();
  unsigned e = 0;
  for (int n = 0; n < pass.blocks; ++n) {
    if (DAMPED && pass.block[n].damped)
      feel<true>(pass, pass.block[n], e, total[n & 1]);
    else
      feel<false>(pass, pass.block[n], e, total[n & 1]);
    if (__builtin_expect(pass.block[n].external_force >= 0, 0)) add_external_force(pass, pass.block[n], total[n & 1]);
    if (n) move<FRICTION, TRACED, DAMPED>(pass, pass.block[n - 1], total[~n & 1], tally);
  }
  if (pass.blocks) move<FRICTION, TRACED, DAMPED>(pass, pass.block[pass.blocks - 1], total[~pass.blocks & 1], tally);

  if (TRACED) tally.turn_to(-1, pass);
  pass.fastest = pass.squares = 0.0;
  for (int lane = 0; lane < LANES; ++lane) {
    if (tally.fastest[lane] > pass.fastest) pass.fastest = tally.fastest[lane];
    pass.squares += tally.squares[lane];
  }
  pass.final_loss = tally.final_loss;
  pass.first_loss = tally.first_loss;
  pass.bend = tally.bend;
  pass.dashpots = tally.dashpots;
}

template <Friction FRICTION, bool TRACED> MDANIM_INLINE void with_or_without_dashpots(Pass &pass)
{
  if (pass.damped_law)
    go<FRICTION, TRACED, true>(pass);
  else
    go<FRICTION, TRACED, false>(pass);
}

template <Friction FRICTION> MDANIM_INLINE void with_or_without_trace(Pass &pass)
{
  if (pass.trace)
    with_or_without_dashpots<FRICTION, true>(pass);
  else
    with_or_without_dashpots<FRICTION, false>(pass);
}

MDANIM_INLINE void whole_pass(Pass &pass)
{
  switch (pass.friction) {
    case Friction::NONE:
      with_or_without_trace<Friction::NONE>(pass);
      break;
    case Friction::IMPLICIT:
      with_or_without_trace<Friction::IMPLICIT>(pass);
      break;
    case Friction::EXPONENTIAL:
      with_or_without_trace<Friction::EXPONENTIAL>(pass);
      break;
  }
}

}    // namespace
}    // namespace mdanim
