// SPDX-License-Identifier: GPL-2.0-only
// The springs of a pass, block by block and strip by strip, for vectors of MDANIM_LANES doubles.

#pragma once

#include "passes/pass.h"
#include "simd/vectors.h"
#include "springs/law.h"

namespace mdanim {
namespace {

constexpr int LANES = MDANIM_LANES;
typedef double Vector __attribute__((vector_size(8 * LANES)));
using Vector3 = Vec<Vector>;

MDANIM_ALWAYS_INLINE Vector load(const double *from) { return load<Vector>(from); }

MDANIM_ALWAYS_INLINE Vector3 load(const double *const *from, long i) { return load<Vector>(from, i); }

typedef float Floats __attribute__((vector_size(4 * LANES)));

MDANIM_ALWAYS_INLINE Vector load_floats(const float *from) { return __builtin_convertvector(load<Floats>(from), Vector); }

MDANIM_ALWAYS_INLINE void store_floats(float *to, const Vector &value) { store(to, __builtin_convertvector(value, Floats)); }

// Loads components of a block's own numbers, LANES of each.
MDANIM_ALWAYS_INLINE Vector3 load_own(const double *from) { return {load(from), load(from + LANES), load(from + 2 * LANES)}; }

MDANIM_ALWAYS_INLINE void store_own(double *to, const Vector3 &value)
{
  store(to, value.x);
  store(to + LANES, value.y);
  store(to + 2 * LANES, value.z);
}

// Vectors of numbers that a block adds up: forces on its particles from upper partners, and what dashpots take.
template <bool DAMPED> constexpr int FELT = DAMPED ? 5 : 3;
template <bool DAMPED> constexpr int COEFFS = DAMPED ? 3 : 2;

struct Felt {
  Vector3 force;
  DashpotWork<Vector> taken;

  template <bool DAMPED> MDANIM_ALWAYS_INLINE static Felt from(const double *row)
  { return {load_own(row), {DAMPED ? load(row + 3 * LANES) : Vector{}, DAMPED ? load(row + 4 * LANES) : Vector{}}}; }
  template <bool DAMPED> MDANIM_ALWAYS_INLINE void put(double *row) const
  {
    store_own(row, force);
    if (DAMPED) store(row + 3 * LANES, taken.work), store(row + 4 * LANES, taken.bend);
  }
};

// Particles in all lanes: where they are, and with dashpots how fast.
template <bool DAMPED> struct Lanes {
  Vector3 x, v;

  template <class Place> MDANIM_ALWAYS_INLINE static Lanes at(double *const *x, double *const *v, long i, const Place &place)
  { return {place(x, i), DAMPED ? place(v, i) : Vector3{}}; }
};

// Forces of springs on particles from their partners, by a row of Pass::law or Pass::damped_law; `rate` is their row of
// Pass::rate.
template <bool DAMPED>
MDANIM_ALWAYS_INLINE Vector3 force_of(const double *coeffs, const Lanes<DAMPED> &here, const Lanes<DAMPED> &there, double dt,
                                      float *rate, DashpotWork<Vector> &taken)
{
  const Vector3 d = here.x - there.x;
  const Vector square = floored_square(d);
  Vector factor = spring_factor(load(coeffs), load(coeffs + LANES), square);
  if constexpr (DAMPED) {
    const Vector3 faster = here.v - there.v;
    const Vector c = load(coeffs + 2 * LANES), along = dot(faster, d), now = along / square;
    const DashpotWork<Vector> one = dashpot_work(along, square, dot(faster, faster), now, load_floats(rate), dt);
    factor -= c * now;
    taken.work += c * one.work;
    taken.bend += c * one.bend;
    store_floats(rate, now);
  }
  return factor * d;
}

// Whether offsets of three entries, of `left`, differ by one: they push the same particles, one lane aside.
MDANIM_ALWAYS_INLINE bool are_three(const Entry *entry, long left)
{ return left >= 3 && entry[1].offset == entry[0].offset - 1 && entry[2].offset == entry[0].offset - 2; }

// Takes what three such entries push from f, in their order, `along` from the places from j on: each place is loaded and stored
// once.
MDANIM_ALWAYS_INLINE void push_three(double *f, long j, const Vector &up, const Vector &along, const Vector &down)
{
  const Vector low = ((load(f + j - 1) - from_last_two(Vector{}, up)) - from_last(Vector{}, along)) - down;
  const Two high = (load<Two>(f + j - 1 + LANES) - last_two(up)) - last_and_first(along, Vector{});
  store(f + j - 1, low);
  store(f + j - 1 + LANES, high);
}

// Evaluates the springs of a block, each once, and the dashpots beside them: forces on its own particles go into `felt`, those on
// their partners into f. place(array, i) gives the lanes of particles from i on. THREES: three entries whose offsets differ by
// one are taken together.
template <bool DAMPED, bool THREES = false, class Place>
MDANIM_ALWAYS_INLINE void add_springs(const Pass &pass, const Entry *entry, unsigned &e, unsigned end, unsigned rates, int i,
                                      double *const *of_f, Felt &felt, const Place &place)
{
  double *const x[] = {pass.x[0], pass.x[1], pass.x[2]}, *const v[] = {pass.v[0], pass.v[1], pass.v[2]};
  double *const f[] = {of_f[0], of_f[1], of_f[2]};
  const double *const coeffs = DAMPED ? pass.damped_law : pass.law, dt = pass.dt;
  float *rate = DAMPED ? pass.rate + static_cast<unsigned long>(rates) * LANES : nullptr;
  const auto here = Lanes<DAMPED>::at(x, v, i, place);
  for (; e < end; ++e, rate += LANES) {
    const int j = i + entry[e].offset;
    const auto force_from = [&](unsigned n, int at) __attribute__((always_inline)) {
      const double *const own = coeffs + static_cast<unsigned long>(entry[n].law) * (COEFFS<DAMPED> * LANES);
      return force_of<DAMPED>(own, here, Lanes<DAMPED>::at(x, v, at, place), dt, rate, felt.taken);
    };
    if constexpr (THREES) {
      if (are_three(entry + e, end - e)) {
        const Vector3 up = force_from(e, j), along = force_from(e + 1, j - 1), down = force_from(e + 2, j - 2);
        felt.force = ((felt.force + up) + along) + down;
        push_three(f[0], j - 1, up.x, along.x, down.x);
        push_three(f[1], j - 1, up.y, along.y, down.y);
        push_three(f[2], j - 1, up.z, along.z, down.z);
        e += 2;
        continue;
      }
    }
    const Vector3 force = force_from(e, j);
    felt.force += force;
    store(f, j, load(f, j) - force);
  }
}

MDANIM_ALWAYS_INLINE Vector3 from_last(const Vector3 &a, const Vector3 &b)
{ return {from_last(a.x, b.x), from_last(a.y, b.y), from_last(a.z, b.z)}; }

MDANIM_ALWAYS_INLINE Vector3 from_second(const Vector3 &a, const Vector3 &b)
{ return {from_second(a.x, b.x), from_second(a.y, b.y), from_second(a.z, b.z)}; }

// Whether what two entries push overlaps neither in one block nor from it to the next.
MDANIM_ALWAYS_INLINE bool are_apart(const Entry &longer, const Entry &shorter)
{ return longer.offset - shorter.offset >= 2 * LANES; }

// Evaluates three such entries of all blocks of a strip, and in the same go one before them or behind them that is apart. The
// forces that the three push with are added up in registers, in the same order. `open` are those on LANES partners of a block
// that lack the lowest offset of the next block.
template <bool BEFORE, bool BEHIND>
MDANIM_ALWAYS_INLINE void feel_three(const Pass &pass, const Block *block, const Entry *entry, long entries, double *felt,
                                     bool first)
{
  const double *const x[] = {pass.x[0], pass.x[1], pass.x[2]};
  double *const f[] = {pass.range->f[0], pass.range->f[1], pass.range->f[2]};
  double *const end = felt + block->strip * (3 * LANES);
  const long longer = BEFORE ? entry[0].offset : 0, middle = entry[BEFORE + 1].offset,
             shorter = BEHIND ? entry[BEFORE + 3].offset : 0;
  long i = block->start, j = i + middle;
  Vector3 open = load<Vector>(f, j - LANES), high{}, low{};
  for (; felt < end; felt += 3 * LANES, entry += entries, i += LANES, j += LANES) {
    const Vector3 here = load<Vector>(x, i);
    const auto force = [&](int n, long at) __attribute__((always_inline)) {
      const double *const coeffs = pass.law + static_cast<unsigned long>(entry[n].law) * (2 * LANES);
      const Vector3 d = here - load<Vector>(x, at);
      return spring_factor(load(coeffs), load(coeffs + LANES), floored_square(d)) * d;
    };
    Vector3 sum = first ? Vector3{} : load_own(felt);
    const auto push_one = [&](int n, long at) __attribute__((always_inline)) {
      const Vector3 one = force(n, at);
      sum += one;
      store(f, at, load<Vector>(f, at) - one);
    };
    if (BEFORE) push_one(0, i + longer);
    const Vector3 up = force(BEFORE, j + 1), along = force(BEFORE + 1, j), down = force(BEFORE + 2, j - 1);
    sum = ((sum + up) + along) + down;
    if (BEHIND) push_one(BEFORE + 3, i + shorter);
    store_own(felt, sum);
    store(f, j - LANES, open - from_second(low, down));
    open = (load<Vector>(f, j) - from_last(high, up)) - along;
    high = up, low = down;
  }
  store(f, j - LANES, open - from_second(low, Vector3{}));
  store(f, j, load<Vector>(f, j) - from_last(high, Vector3{}));
}

// The number of entries of a strip, of those that are left, that were taken in one go; 0 where they are to be taken one by one.
MDANIM_ALWAYS_INLINE long feel_together(const Pass &pass, const Block *block, const Entry *entry, long entries, long left,
                                        double *felt)
{
  const bool first = left == entries, before = !are_three(entry, left);
  if (before && !(are_three(entry + 1, left - 1) && are_apart(entry[0], entry[1]))) return 0;
  const Entry *const next = entry + before + 3;
  left -= before + 3;
  const bool behind = left > 0 && are_apart(next[-1], *next) && !are_three(next, left);
  if (before)
    behind ? feel_three<true, true>(pass, block, entry, entries, felt, first)
           : feel_three<true, false>(pass, block, entry, entries, felt, first);
  else
    behind ? feel_three<false, true>(pass, block, entry, entries, felt, first)
           : feel_three<false, false>(pass, block, entry, entries, felt, first);
  return before + 3 + behind;
}

// Evaluates the springs of a strip, offset by offset; what its blocks add up goes into rows of `felt`. Block by block a load of
// forces on partners overlaps the store for the offset before, which differs by a row or by one place, and waits until that store
// has reached the cache. In a strip the same places come again after all of its blocks. Each sum keeps its order: a longer offset
// leads to a particle from a lower one.
template <bool DAMPED>
__attribute__((noinline)) void feel_strip(const Pass &pass, const Block *block, unsigned first_entry, double *felt)
{
  constexpr int NUMBERS = FELT<DAMPED> * LANES;
  double *const x[] = {pass.x[0], pass.x[1], pass.x[2]}, *const v[] = {pass.v[0], pass.v[1], pass.v[2]};
  double *const f[] = {pass.range->f[0], pass.range->f[1], pass.range->f[2]};
  const double *const law = DAMPED ? pass.damped_law : pass.law, dt = pass.dt;
  const long entries = block->end - first_entry, of_entry = block->strip * LANES;
  double *const end = felt + block->strip * NUMBERS;
  float *const rates = DAMPED ? pass.rate + static_cast<unsigned long>(block->rates) * LANES : nullptr;
  const auto place = [](double *const *from, long i) __attribute__((always_inline)) { return load<Vector>(from, i); };
  const auto add = [&](long i, long j, unsigned of_law, float *rate, Felt sum, double *to) __attribute__((always_inline)) {
    const double *const own = law + static_cast<unsigned long>(of_law) * (COEFFS<DAMPED> * LANES);
    const Vector3 force =
        force_of<DAMPED>(own, Lanes<DAMPED>::at(x, v, i, place), Lanes<DAMPED>::at(x, v, j, place), dt, rate, sum.taken);
    sum.force += force;
    sum.put<DAMPED>(to);
    store(f, j, load<Vector>(f, j) - force);
  };
  for (long k = 0; k < entries; ++k) {
    const Entry *entry = pass.entry + first_entry + k;
    float *rate = DAMPED ? rates + k * of_entry : nullptr;
    if constexpr (!DAMPED && LANES > 4) {    // else it does not pay (docs/decisions/one-pass.md)
      if (const long taken = feel_together(pass, block, entry, entries, entries - k, felt)) {
        k += taken - 1;
        continue;
      }
    }
    long i = block->start, j = i + entry->offset;
    for (double *to = felt; to < end; to += NUMBERS, entry += entries, i += LANES, j += LANES, rate += LANES)
      add(i, j, entry->law, rate, k == 0 ? Felt{} : Felt::from<DAMPED>(to), to);
  }
}

// Adds up the forces on a block's own particles, with gravity, and what dashpots take behind them.
template <bool DAMPED> MDANIM_ALWAYS_INLINE void add_up(const Pass &pass, const Block &block, const Felt &felt, double *total)
{
  double *const f[] = {pass.range->f[0], pass.range->f[1], pass.range->f[2]};
  const int i = block.start;
  const double *const motion = pass.motion + static_cast<unsigned long>(block.motion) * (MOTIONS * LANES);
  const Vector mass = load(motion + MASS * LANES), others = load(motion + FOREIGN_LANE * LANES);
  const Vector3 received = load(f, i),
                gravity{mass * pass.gravity.now[0], mass * pass.gravity.now[1], mass * pass.gravity.now[2]};
  store(f, i, others * received);
  Felt{(received + felt.force) + gravity, felt.taken}.put<DAMPED>(total);
}

template <bool DAMPED> MDANIM_ALWAYS_INLINE void feel(const Pass &pass, const Block &block, unsigned &e, double *total)
{
  constexpr bool THREES = !DAMPED && LANES > 4;    // else it does not pay (docs/decisions/one-pass.md)
  Felt felt{};
  const auto place = [](double *const *from, int i) { return load(from, i); };
  if (THREES && block.overlaps)
    add_springs<DAMPED, THREES>(pass, pass.entry, e, block.end, block.rates, block.start, pass.range->f, felt, place);
  else
    add_springs<DAMPED>(pass, pass.entry, e, block.end, block.rates, block.start, pass.range->f, felt, place);
  add_up<DAMPED>(pass, block, felt, total);
}

}    // namespace
}    // namespace mdanim
