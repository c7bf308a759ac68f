// SPDX-License-Identifier: GPL-2.0-only
// Vectors of LANES doubles, for code that is compiled once for each kind of processor: whoever includes this says how many lanes.

#ifndef MDANIM_VECTORS_H
#define MDANIM_VECTORS_H

namespace mdanim {
namespace {

#define MDANIM_INLINE inline __attribute__((always_inline))

typedef double Vector __attribute__((vector_size(8 * LANES)));

struct __attribute__((packed, may_alias)) Unaligned {
  Vector value;
};

MDANIM_INLINE Vector load(const double *from) { return reinterpret_cast<const Unaligned *>(from)->value; }

MDANIM_INLINE void store(double *to, Vector value) { reinterpret_cast<Unaligned *>(to)->value = value; }

MDANIM_INLINE Vector root(Vector a)
{
  Vector r;
  for (int lane = 0; lane < LANES; ++lane) r[lane] = __builtin_sqrt(a[lane]);
  return r;
}

}    // namespace
}    // namespace mdanim

#endif
