// SPDX-License-Identifier: GPL-2.0-only
// The loops of an update of waves for one set of instructions (simd/of_set.h).

#include "liquid/waves/waves_kernels.h"

#include "liquid/waves/waves_link_steps.h"
#include "simd/of_set.h"

// A lambda that takes the attribute of the function that calls it.
#define MDANIM_INLINED __attribute__((always_inline))

namespace mdanim {

namespace {

// Two kinds of vectors, with the integers of their lanes.
typedef long long FourUnits __attribute__((vector_size(32)));
typedef double Eight __attribute__((vector_size(64)));
typedef long long EightUnits __attribute__((vector_size(64)));

template <class Vector> struct UnitsOf;
template <> struct UnitsOf<Four> {
  using Type = FourUnits;
};
template <> struct UnitsOf<Eight> {
  using Type = EightUnits;
};

template <class Vector> constexpr int LANES = sizeof(Vector) / sizeof(double);

// Whole numbers below 2^51 are the last bits of a number of 1.5 * 2^52 and more.
constexpr double BIG = 6755399441055744.0;
constexpr long long BITS_OF_BIG = 0x4338000000000000;

template <class Vector> MDANIM_ALWAYS_INLINE Vector load_units(const std::int64_t *from)
{
  using Ints = typename UnitsOf<Vector>::Type;
  const Ints units = reinterpret_cast<const Unaligned<Ints> *>(from)->value;
  return __builtin_bit_cast(Vector, units + BITS_OF_BIG) - BIG;
}

template <class Vector> MDANIM_ALWAYS_INLINE void add_units(std::int64_t *to, const Vector &units)
{
  using Ints = typename UnitsOf<Vector>::Type;
  auto *sum = reinterpret_cast<Unaligned<Ints> *>(to);
  sum->value = sum->value + (__builtin_bit_cast(Ints, units + BIG) - BITS_OF_BIG);
}

// Calls f(place) for each vector of these rows.
template <class Vector, class F> MDANIM_ALWAYS_INLINE void each(const WaveArrays &a, long first, long end, const F &f)
{
  for (long i = first * a.stride; i < end * a.stride; i += LANES<Vector>) f(i);
}

// Sums f(place) over each row: eight parts, added in pairs.
template <class Vector, class F>
MDANIM_ALWAYS_INLINE void sum_rows_to(double *sums, const WaveArrays &a, long first, long end, const F &f)
{
  constexpr int VECTORS = WaveKernels::SUMMED / LANES<Vector>;
  for (long row = first; row < end; ++row) {
    Vector sum[VECTORS] = {};
    for (long i = row * a.stride; i < (row + 1) * a.stride; i += WaveKernels::SUMMED)
#pragma GCC unroll 2
      for (int n = 0; n < VECTORS; ++n) sum[n] += f(i + n * LANES<Vector>);
    double part[WaveKernels::SUMMED];
    for (int n = 0; n < VECTORS; ++n) store(part + n * LANES<Vector>, sum[n]);
    sums[row] = ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]));
  }
}

template <class Vector, class F> MDANIM_ALWAYS_INLINE void sum_rows(const WaveArrays &a, long first, long end, const F &f)
{ sum_rows_to<Vector>(a.sums, a, first, end, f); }

namespace kernel {

template <class Vector> bool surfaces(const WaveArrays &a, const WaveLaw &law, long first, long end)
{
  Vector some_full{};
  const Vector per_unit = constant<Vector>(1.0 / law.units_per_cell);
  each<Vector>(a, first, end, [&](long i) MDANIM_INLINED {
    const Vector volume = load_units<Vector>(a.content + i) * per_unit, capacity = load<Vector>(a.capacity + i);
    const Vector roof = load<Vector>(a.roof + i), free_head = pick(volume >= capacity, roof, load<Vector>(a.floor + i) + volume);
    const auto s =
        surface(volume, capacity, roof, free_head, load<Vector>(a.full + i), load<Vector>(a.rest + i), load<Vector>(a.phi + i));
    store(a.volume + i, volume);
    store(a.full + i, s.full);
    store(a.rest + i, s.rest);
    store(a.phi + i, s.phi);
    store(a.head + i, s.head);
    store(a.slope + i, constant<Vector>(1.0));
    some_full = larger(some_full, s.full);
  });
  return any(some_full > Vector{});
}

// The opening of a link up to a level where solids are only at the ends of its spans.
template <class Vector> MDANIM_ALWAYS_INLINE auto opening(const LinkAt &at)
{
  const Vector edge = load<Vector>(at.links.edge + at.link), top = load<Vector>(at.links.top + at.link);
  return [edge, top](const Vector &level) MDANIM_INLINED { return smaller(level, top) - edge; };
}

template <class Vector> void open_links(const WaveArrays &a, const WaveLaw &law, int d, long first, long end)
{
  const long along = d == 0 ? 1 : a.stride;
  each<Vector>(a, first, end, [&](long i) MDANIM_INLINED {
    const LinkAt at{a.links[d], d, i, i, i + along};
    open_at<Vector>(a, law, at, opening<Vector>(at));
  });
}

template <class Vector> void advect(const WaveArrays &a, const WaveLaw &law, int d, long first, long end)
{
  const WaveLinks &links = a.links[d];
  const double *q = links.q, *across_q = a.links[1 - d].q;
  const long along = d == 0 ? 1 : a.stride, across = d == 0 ? a.stride : 1;
  const Vector half = constant<Vector>(0.5), none{};
  each<Vector>(a, first, end, [&](long i) MDANIM_INLINED {
    const Vector u = load<Vector>(links.u + i), own = load<Vector>(q + i);
    Around<Vector> around;
    const long at[4] = {i - along, i + along, i - across, i + across};
#pragma GCC unroll 4
    for (int n = 0; n < 4; ++n) {
      around.u[n] = load<Vector>(links.u + at[n]);
      around.height[n] = load<Vector>(links.height + at[n]);
    }
    around.inflow[0] = half * (load<Vector>(q + at[0]) + own);
    around.inflow[1] = none - half * (own + load<Vector>(q + at[1]));
    around.inflow[2] = half * (load<Vector>(across_q + i - across) + load<Vector>(across_q + i - across + along));
    around.inflow[3] = none - half * (load<Vector>(across_q + i) + load<Vector>(across_q + i + along));
    const auto found =
        advected(law, u, around, load<Vector>(a.volume + i), load<Vector>(a.volume + i + along), load<Vector>(links.height + i));
    const auto wet = load<Vector>(links.wet + i) > none;
    store(links.faster + i, pick(wet, found.u, none));
    if (law.bed > 0.0) store(links.rubbed + i, pick(wet, found.rubbed, none));
  });
}

// Calls f(direction, link, other span, whether flux along the link comes in) for the links of span i in the order in which they
// are summed: from below and from the left, to the right and up.
template <class F> MDANIM_ALWAYS_INLINE void links_of(const WaveArrays &a, long i, const F &f)
{
  f(1, i - a.stride, i - a.stride, true);
  f(0, i - 1, i - 1, true);
  f(0, i, i + 1, false);
  f(1, i, i + a.stride, false);
}

template <class Vector, bool SOME_FULL>
MDANIM_ALWAYS_INLINE void assemble(const WaveArrays &a, const WaveLaw &law, long first, long end)
{
  const Vector none{};
  each<Vector>(a, first, end, [&](long i) MDANIM_INLINED {
    const Vector head = load<Vector>(a.head + i), volume = load<Vector>(a.volume + i);
    SpanSums<Vector> sums;
    links_of(a, i, [&](int d, long link, long other, bool inward) MDANIM_INLINED {
      const WaveLinks &links = a.links[d];
      const Vector beside = load<Vector>(a.head + other), wet = load<Vector>(links.wet + link);
      if (SOME_FULL) {
        const Vector faster = load<Vector>(links.faster + link) - constant<Vector>(law.dt * law.tilt[d]);
        const Vector flux = load<Vector>(links.height + link) * faster * constant<Vector>(law.dt);
        sums.look(head, beside, wet, load<Vector>(a.full + i), load<Vector>(a.full + other), inward ? flux : none - flux);
      } else {
        sums.look(head, beside, wet);
      }
    });
    sums.diagonal = free_stiffness(law, sums.steepest, volume, load<Vector>(a.slope + i));
    if (SOME_FULL) {
      const auto full = load<Vector>(a.full + i) > none;
      sums.diagonal = pick(full, load<Vector>(a.yields + i) * constant<Vector>(1.0 / (law.share * law.share)), sums.diagonal);
      sums.rhs = pick(full, full_rhs(law, volume, load<Vector>(a.capacity + i), load<Vector>(a.coming + i), sums.inflow), none);
      store(a.beside_full + i, sums.beside_full);
    }
    const Vector stiffness = sums.diagonal;
    links_of(a, i, [&](int d, long link, long other, bool inward) MDANIM_INLINED {
      const WaveLinks &links = a.links[d];
      sums.couple(head, load<Vector>(a.head + other), load<Vector>(links.edge + link), load<Vector>(links.height + link),
                  inward ? law.tilt[d] : -law.tilt[d]);
    });
    const auto solved = sums.diagonal > none;
    const Vector one = constant<Vector>(1.0), scale = one / root(pick(solved, sums.diagonal, one));
    store(a.scale + i, scale);
    store(a.flat + i, pick(sums.diagonal > stiffness, one / scale, none));
    store(a.rhs + i, pick(solved, sums.rhs * scale, none));
  });
}

template <class Vector> void couple(const WaveArrays &a, long first, long end)
{
  for (int d = 0; d < 2; ++d) {
    const WaveLinks &links = a.links[d];
    const long along = d == 0 ? 1 : a.stride;
    each<Vector>(a, first, end, [&](long i) MDANIM_INLINED {
      const Vector bare = coupling(load<Vector>(a.head + i), load<Vector>(a.head + i + along), load<Vector>(links.edge + i),
                                   load<Vector>(links.height + i));
      store(links.couple + i, bare * load<Vector>(a.scale + i) * load<Vector>(a.scale + i + along));
    });
  }
}

template <class Vector> void guess(const WaveArrays &a, bool again, long first, long end)
{
  sum_rows<Vector>(a, first, end, [&](long i) MDANIM_INLINED {
    const Vector delta = load<Vector>(a.delta + i), last = load<Vector>(a.last_delta + i);
    const Vector expected = again ? load<Vector>(a.p + i) : (delta + delta) - last;
    store(a.x + i, expected / load<Vector>(a.scale + i));
    const Vector rhs = load<Vector>(a.rhs + i);
    return rhs * rhs;
  });
}

// A x at one place. x(place) is that of the solver; the diagonal of A is 1.
template <class Vector, class X> MDANIM_ALWAYS_INLINE Vector apply(const WaveArrays &a, long i, const X &x)
{
  Vector sum = x(i);
  links_of(a, i,
           [&](int d, long link, long other, bool) MDANIM_INLINED { sum -= load<Vector>(a.links[d].couple + link) * x(other); });
  return sum;
}

template <class Vector> void start(const WaveArrays &a, long first, long end)
{
  sum_rows<Vector>(a, first, end, [&](long i) MDANIM_INLINED {
    const auto x = [&](long j) MDANIM_INLINED { return load<Vector>(a.x + j); };
    const Vector r = load<Vector>(a.rhs + i) - apply<Vector>(a, i, x);
    store(a.r + i, r);
    store(a.p + i, Vector{});
    return r * r;
  });
}

template <class Vector, bool LIFTED>
MDANIM_ALWAYS_INLINE void turn(const WaveArrays &a, double alpha, double beta, const double *lift, long first, long end)
{
  const Vector step = constant<Vector>(alpha), factor = constant<Vector>(beta);
  for (long row = first; row < end; ++row) {
    const double *const lifted = LIFTED ? lift + ((row - 1) / WaveKernels::BLOCK - row) * a.stride : nullptr;
    each<Vector>(a, row, row + 1, [&](long i) MDANIM_INLINED {
      const Vector p = load<Vector>(a.p + i);
      Vector r = load<Vector>(a.r + i);
      if (LIFTED) r += load<Vector>(a.flat + i) * load<Vector>(lifted + i);
      store(a.x + i, load<Vector>(a.x + i) + step * p);
      store(a.p + i, r + factor * p);
    });
  }
}

template <class Vector> void turn(const WaveArrays &a, double alpha, double beta, const double *lift, long first, long end)
{ lift ? turn<Vector, true>(a, alpha, beta, lift, first, end) : turn<Vector, false>(a, alpha, beta, lift, first, end); }

template <class Vector> void product(const WaveArrays &a, long first, long end)
{
  sum_rows<Vector>(a, first, end, [&](long i) MDANIM_INLINED {
    const auto p = [&](long j) MDANIM_INLINED { return load<Vector>(a.p + j); };
    const Vector ap = apply<Vector>(a, i, p);
    store(a.ap + i, ap);
    return p(i) * ap;
  });
}

template <class Vector> void advance(const WaveArrays &a, double alpha, long first, long end)
{
  const Vector factor = constant<Vector>(alpha);
  sum_rows<Vector>(a, first, end, [&](long i) MDANIM_INLINED {
    const Vector r = load<Vector>(a.r + i) - factor * load<Vector>(a.ap + i);
    store(a.r + i, r);
    return r * r;
  });
}

template <class Vector> void finish(const WaveArrays &a, double alpha, long first, long end)
{
  const Vector step = constant<Vector>(alpha);
  each<Vector>(a, first, end,
               [&](long i) MDANIM_INLINED { store(a.x + i, load<Vector>(a.x + i) + step * load<Vector>(a.p + i)); });
}

// Sums of four numbers each.
template <class Vector> MDANIM_ALWAYS_INLINE void store_by_four(double *to, const Vector &numbers)
{
  double part[LANES<Vector>];
  store(part, numbers);
  for (int n = 0; n < LANES<Vector>; n += 4) to[n / 4] = (part[n] + part[n + 1]) + (part[n + 2] + part[n + 3]);
}

template <class Vector> void gather(const WaveArrays &a, double *to, long first, long end)
{
  each<Vector>(a, first, end, [&](long i) MDANIM_INLINED {
    store_by_four<Vector>(to + i / WaveKernels::BLOCK, load<Vector>(a.flat + i) * load<Vector>(a.r + i));
  });
}

template <class Vector> void blocks(const WaveArrays &a, const BlockSums &sums, long first, long end)
{
  constexpr int EDGE = WaveKernels::BLOCK;
  Vector inside, across{};    // lanes of links within a block, and of those to the next one
  for (int n = 0; n < LANES<Vector>; ++n)
    inside[n] = n % EDGE < EDGE - 1 ? 2.0 : 0.0, across[n] = n % EDGE < EDGE - 1 ? 0.0 : 1.0;
  const Vector two = constant<Vector>(2.0);
  for (long row = first; row < end; ++row)
    for (long x = 0; x < a.stride; x += LANES<Vector>) {
      Vector diagonal{}, east{}, north{};
      for (long y = 1 + EDGE * row; y < 1 + EDGE * (row + 1) && y < sums.end_row; ++y) {
        const long i = y * a.stride + x;
        const Vector flat = load<Vector>(a.flat + i);
        const Vector to_east = load<Vector>(a.links[0].couple + i) * flat * load<Vector>(a.flat + i + 1);
        const Vector to_north = load<Vector>(a.links[1].couple + i) * flat * load<Vector>(a.flat + i + a.stride);
        diagonal += flat * flat - inside * to_east;
        east += across * to_east;
        if (y == EDGE * (row + 1))
          north = to_north;
        else
          diagonal -= two * to_north;
      }
      const long to = (row * a.stride + x) / EDGE;
      store_by_four<Vector>(sums.diagonal + to, diagonal);
      store_by_four<Vector>(sums.couple[0] + to, east);
      store_by_four<Vector>(sums.couple[1] + to, north);
    }
}

template <class Vector> void sum(const WaveArrays &arrays, const double *a, const double *b, long first, long end)
{
  sum_rows<Vector>(arrays, first, end, [&](long i) MDANIM_INLINED { return load<Vector>(a + i) * load<Vector>(b + i); });
}

template <class Vector> void heads(const WaveArrays &a, const WaveLaw &law, long first, long end)
{
  const Vector part = constant<Vector>(1.0 / law.mean_over);
  each<Vector>(a, first, end, [&](long i) MDANIM_INLINED {
    const Vector delta = load<Vector>(a.scale + i) * load<Vector>(a.x + i), full = load<Vector>(a.full + i);
    const Vector phi =
        pushing_head(law, load<Vector>(a.head + i), delta, load<Vector>(a.volume + i), full, load<Vector>(a.beside_full + i));
    const Vector rest = load<Vector>(a.rest + i), mean = rest + (larger(phi, load<Vector>(a.roof + i)) - rest) * part;
    store(a.phi + i, phi);
    store(a.rest + i, pick(full > Vector{}, mean, rest));
    store(a.last_delta + i, load<Vector>(a.delta + i));
    store(a.delta + i, delta);
  });
}

template <class Vector> void push(const WaveArrays &a, const WaveLaw &law, int d, long first, long end)
{
  const WaveLinks &links = a.links[d];
  const long along = d == 0 ? 1 : a.stride;
  sum_rows_to<Vector>(links.moving, a, first, end, [&](long i) MDANIM_INLINED {
    const LinkAt at{links, d, i, i, i + along};
    push_at<Vector>(a, law, at, opening<Vector>(at));
    return load<Vector>(links.height + i) * load<Vector>(links.faster + i);
  });
  if (law.bed > 0.0)
    sum_rows_to<Vector>(links.rubbing, a, first, end,
                        [&](long i) MDANIM_INLINED { return load<Vector>(links.height + i) * load<Vector>(links.rubbed + i); });
}

template <class Vector> double fastest(const WaveArrays &a, long first, long end)
{
  Vector most{};
  each<Vector>(a, first, end, [&](long i) MDANIM_INLINED {
    for (const WaveLinks &links : a.links) {
      const Vector u = load<Vector>(links.u + i);
      most = larger(most, larger(u, Vector{} - u));
    }
  });
  double u = 0.0;
  for (int lane = 0; lane < LANES<Vector>; ++lane) u = larger<double>(u, most[lane]);
  return u;
}

template <class Vector> bool balance(const WaveArrays &a, const WaveLaw &law, long first, long end)
{
  Vector least = constant<Vector>(1.0);
  const Vector per_cell = constant<Vector>(law.units_per_cell), spare = constant<Vector>(0.25 * law.units_per_cell);
  each<Vector>(a, first, end, [&](long i) MDANIM_INLINED {
    SpanFluxes<Vector> fluxes;
    links_of(a, i, [&](int d, long link, long, bool inward) MDANIM_INLINED {
      const Vector units = load<Vector>(a.links[d].units + link);
      fluxes.add(inward ? units : Vector{} - units);
    });
    store(a.net + i, fluxes.in - fluxes.out);
    const Vector content = load<Vector>(a.volume + i) * per_cell, most = load<Vector>(a.capacity + i) * per_cell + spare;
    least = smaller(least, smaller(fluxes.out_share(content), fluxes.in_share(content, most)));
  });
  return !any(least < constant<Vector>(1.0));
}

template <class Vector> void settle(const WaveArrays &a, const WaveLaw &law, long first, long end)
{
  const Vector flux = constant<Vector>(1.0 / (law.units_per_cell * law.dt));
  each<Vector>(a, first, end, [&](long i) MDANIM_INLINED {
    add_units(a.content + i, load<Vector>(a.net + i));
    for (const WaveLinks &links : a.links) store(links.q + i, load<Vector>(links.units + i) * flux);
  });
}

}    // namespace kernel
}    // namespace

#undef MDANIM_INLINED

// GCC 12 splits selections among eight numbers into single ones: only the solver, which has none, is faster with them.
namespace {
#if MDANIM_LANES == 8
using Wide = Eight;
#else
using Wide = Four;
#endif
void assemble(const WaveArrays &a, const WaveLaw &law, bool some_full, long first, long end)
{ some_full ? kernel::assemble<Four, true>(a, law, first, end) : kernel::assemble<Four, false>(a, law, first, end); }
}    // namespace

extern const WaveKernels MDANIM_OF_SET(wave_kernels);
const WaveKernels MDANIM_OF_SET(wave_kernels) = {
    kernel::surfaces<Four>, kernel::open_links<Four>, kernel::advect<Four>, assemble,
    kernel::couple<Wide>,   kernel::guess<Wide>,      kernel::start<Wide>,  kernel::turn<Wide>,
    kernel::product<Wide>,  kernel::advance<Wide>,    kernel::finish<Wide>, kernel::gather<Wide>,
    kernel::blocks<Wide>,   kernel::sum<Wide>,        kernel::heads<Four>,  kernel::push<Four>,
    kernel::fastest<Four>,  kernel::balance<Four>,    kernel::settle<Four>,
};

}    // namespace mdanim
