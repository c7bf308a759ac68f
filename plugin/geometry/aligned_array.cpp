// SPDX-License-Identifier: GPL-2.0-only
// Allocation of aligned arrays.

#include "geometry/aligned_array.h"

#include <algorithm>
#include <cstdint>

namespace mdanim {

template <class Number> void Aligned<Number>::assign(std::size_t n)
{
  constexpr std::size_t LINE = 64 / sizeof(Number);
  room.assign(n + 2 * LINE, 0);
  const auto address = reinterpret_cast<std::uintptr_t>(room.data()) / sizeof(Number);
  begin = room.data() + (LINE - address % LINE) % LINE;
  used = n;
}

template <class Number> void Aligned<Number>::push(const Number *row, std::size_t n)
{
  if (!begin || used + n + 128 / sizeof(Number) > room.size()) {
    std::vector<Number> old(begin, begin + used);
    const std::size_t before = used;
    assign(2 * (used + n));
    std::copy(old.begin(), old.end(), begin);
    used = before;
  }
  std::copy(row, row + n, begin + used);
  used += n;
}

template class Aligned<double>;
template class Aligned<float>;

}    // namespace mdanim
