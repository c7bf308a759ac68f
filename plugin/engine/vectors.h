// SPDX-License-Identifier: GPL-2.0-only
// Vectors of doubles in memory, for the kernels (kernels_of_set.cpp).

#ifndef MDANIM_VECTORS_H
#define MDANIM_VECTORS_H

#include "laws/vec3.h"

namespace mdanim {
namespace {

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

template <class Vector> MDANIM_ALWAYS_INLINE Vector load(const double *from)
{ return reinterpret_cast<const Unaligned<Vector> *>(from)->value; }

template <class Vector> MDANIM_ALWAYS_INLINE void store(double *to, const Vector &value)
{ reinterpret_cast<Unaligned<Vector> *>(to)->value = value; }

// Arrays of all x, all y, all z, at place i.
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

#endif
