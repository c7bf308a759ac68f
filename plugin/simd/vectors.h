// SPDX-License-Identifier: GPL-2.0-only
// Vectors of numbers in memory, for the kernels (of_set.h).

#pragma once

#include "numbers/vec3.h"

namespace mdanim {
namespace {

typedef double Two __attribute__((vector_size(16)));
typedef double Four __attribute__((vector_size(32)));

// Bit n tells whether a comparison is true in lane n.
template <class Yes> MDANIM_ALWAYS_INLINE int bits(const Yes &yes)
{
#ifdef __AVX2__
  return __builtin_ia32_movmskpd256(reinterpret_cast<Four>(yes));
#else
  return static_cast<int>((yes[0] & 1) | (yes[1] & 2) | (yes[2] & 4) | (yes[3] & 8));
#endif
}

template <class Vector> struct __attribute__((packed, may_alias)) Unaligned {
  Vector value;
};

template <class Vector, class Number> MDANIM_ALWAYS_INLINE Vector load(const Number *from)
{ return reinterpret_cast<const Unaligned<Vector> *>(from)->value; }

template <class Number, class Vector> MDANIM_ALWAYS_INLINE void store(Number *to, const Vector &value)
{
#if !defined(__AVX__) && (defined(__clang__) || __GNUC__ >= 12)
  if constexpr (sizeof(Vector) == 32 && sizeof(Number) == 8) {    // GCC puts a vector that has no register into memory twice
    reinterpret_cast<Unaligned<Two> *>(to)->value = __builtin_shufflevector(value, value, 0, 1);
    reinterpret_cast<Unaligned<Two> *>(to + 2)->value = __builtin_shufflevector(value, value, 2, 3);
    return;
  }
#endif
  reinterpret_cast<Unaligned<Vector> *>(to)->value = value;
}

// Elements of two vectors; elements of the second are numbered after those of the first.
#if defined(__clang__) || __GNUC__ >= 12
#define MDANIM_SHUFFLE(a, b, ...) __builtin_shufflevector(a, b, __VA_ARGS__)
#else
template <int BYTES> struct ShuffledLanes {
  typedef long long Of __attribute__((vector_size(BYTES)));
};
#define MDANIM_SHUFFLE(a, b, ...) __builtin_shuffle(a, b, typename ShuffledLanes<sizeof(a)>::Of{__VA_ARGS__})
#endif

// Lanes of two vectors that follow each other, from the last lane of the first on; from its second one; from its last but one.
template <class Vector> MDANIM_ALWAYS_INLINE Vector from_last(const Vector &a, const Vector &b)
{
  if constexpr (sizeof(Vector) == 64)
    return MDANIM_SHUFFLE(a, b, 7, 8, 9, 10, 11, 12, 13, 14);
  else
    return MDANIM_SHUFFLE(a, b, 3, 4, 5, 6);
}
template <class Vector> MDANIM_ALWAYS_INLINE Vector from_second(const Vector &a, const Vector &b)
{
  if constexpr (sizeof(Vector) == 64)
    return MDANIM_SHUFFLE(a, b, 1, 2, 3, 4, 5, 6, 7, 8);
  else
    return MDANIM_SHUFFLE(a, b, 1, 2, 3, 4);
}

template <class Vector> MDANIM_ALWAYS_INLINE Vector from_last_two(const Vector &a, const Vector &b)
{
  if constexpr (sizeof(Vector) == 64)
    return MDANIM_SHUFFLE(a, b, 6, 7, 8, 9, 10, 11, 12, 13);
  else
    return MDANIM_SHUFFLE(a, b, 2, 3, 4, 5);
}

// The last lane of a vector and the first one of another; and the last two lanes of one.
template <class Vector> MDANIM_ALWAYS_INLINE Two last_and_first(const Vector &a, const Vector &b)
{
  constexpr int LAST = sizeof(Vector) / sizeof(double) - 1;
#if defined(__clang__) || __GNUC__ >= 12
  return __builtin_shufflevector(a, b, LAST, LAST + 1);
#else
  return Two{a[LAST], b[0]};
#endif
}
template <class Vector> MDANIM_ALWAYS_INLINE Two last_two(const Vector &a)
{
  constexpr int LAST = sizeof(Vector) / sizeof(double) - 1;
#if defined(__clang__) || __GNUC__ >= 12
  return __builtin_shufflevector(a, a, LAST - 1, LAST);
#else
  return Two{a[LAST - 1], a[LAST]};
#endif
}

// Exchanges rows and columns.
MDANIM_ALWAYS_INLINE void transpose(Four &a, Four &b, Four &c, Four &d)
{
  const Four p = MDANIM_SHUFFLE(a, b, 0, 4, 2, 6), q = MDANIM_SHUFFLE(a, b, 1, 5, 3, 7);
  const Four r = MDANIM_SHUFFLE(c, d, 0, 4, 2, 6), s = MDANIM_SHUFFLE(c, d, 1, 5, 3, 7);
  a = MDANIM_SHUFFLE(p, r, 0, 1, 4, 5), b = MDANIM_SHUFFLE(q, s, 0, 1, 4, 5);
  c = MDANIM_SHUFFLE(p, r, 2, 3, 6, 7), d = MDANIM_SHUFFLE(q, s, 2, 3, 6, 7);
}

// Turns four records of N numbers into a record of N vectors, and back. row(lane) is the first number of a record.
template <int N, class Row> MDANIM_ALWAYS_INLINE void load_columns(const Row &row, Four (&column)[N])
{
#pragma GCC unroll 16
  for (int next = 0; next < N; next += 4) {
    const int n = next + 4 <= N ? next : N - 4;
    Four a = load<Four>(row(0) + n), b = load<Four>(row(1) + n), c = load<Four>(row(2) + n), d = load<Four>(row(3) + n);
    transpose(a, b, c, d);
    column[n] = a, column[n + 1] = b, column[n + 2] = c, column[n + 3] = d;
  }
}

template <int N, class Row> MDANIM_ALWAYS_INLINE void store_columns(const Four (&column)[N], const Row &row)
{
#pragma GCC unroll 16
  for (int next = 0; next < N; next += 4) {
    const int n = next + 4 <= N ? next : N - 4;
    Four a = column[n], b = column[n + 1], c = column[n + 2], d = column[n + 3];
    transpose(a, b, c, d);
    store(row(0) + n, a), store(row(1) + n, b), store(row(2) + n, c), store(row(3) + n, d);
  }
}

// Components from arrays of all x, all y, all z, at place i.
template <class Vector, class Array> MDANIM_ALWAYS_INLINE Vec<Vector> load(const Array *const *from, long i)
{ return {load<Vector>(from[0] + i), load<Vector>(from[1] + i), load<Vector>(from[2] + i)}; }

template <class Vector> MDANIM_ALWAYS_INLINE void store(double *const *to, long i, const Vec<Vector> &value)
{
  store(to[0] + i, value.x);
  store(to[1] + i, value.y);
  store(to[2] + i, value.z);
}

}    // namespace
}    // namespace mdanim
