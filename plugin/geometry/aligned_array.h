// SPDX-License-Identifier: GPL-2.0-only
// Aligned numbers for the vector units, and positions of particles made of them.

#pragma once

#include "numbers/vec3.h"

#include <array>
#include <cstddef>
#include <vector>

namespace mdanim {

// Numbers that start on a cache line. They may be read and written up to one vector beyond their end.
template <class Number> class Aligned {
 public:
  Aligned() = default;
  Aligned(Aligned &&) = default;    // a copy would point into the other's memory
  Aligned &operator=(Aligned &&) = default;
  void assign(std::size_t n);    // zeros
  void push(const Number *row, std::size_t n);
  void clear() { used = 0; }
  std::size_t size() const { return used; }
  Number *data() { return begin; }
  const Number *data() const { return begin; }
  std::size_t bytes() const { return room.capacity() * sizeof(Number); }

 private:
  std::vector<Number> room;
  Number *begin = nullptr;
  std::size_t used = 0;
};

using Doubles = Aligned<double>;
using Floats = Aligned<float>;

// Positions of particles, all x, all y, all z.
struct Positions {
  Doubles along[3];

  void make_room(std::size_t n)    // loses the contents
  {
    for (Doubles &a : along)
      if (a.size() < n) a.assign(n);
  }
  Vec3 operator[](std::size_t n) const { return {along[0].data()[n], along[1].data()[n], along[2].data()[n]}; }
  void put(std::size_t n, const double *x)
  {
    for (int d = 0; d < 3; ++d) along[d].data()[n] = x[d];
  }
  std::array<const double *, 3> all() const { return {along[0].data(), along[1].data(), along[2].data()}; }
  std::size_t bytes() const { return along[0].bytes() + along[1].bytes() + along[2].bytes(); }
};

}    // namespace mdanim
