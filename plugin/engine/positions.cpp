// SPDX-License-Identifier: GPL-2.0-only
// Room for doubles.

#include "engine/positions.h"

#include <algorithm>
#include <cstdint>

namespace mdanim {

void Doubles::assign(std::size_t n)
{
  constexpr std::size_t LINE = 8;
  room.assign(n + 2 * LINE, 0.0);
  const auto address = reinterpret_cast<std::uintptr_t>(room.data()) / sizeof(double);
  begin = room.data() + (LINE - address % LINE) % LINE;
  used = n;
}

void Doubles::push(const double *row, std::size_t n)
{
  if (!begin || used + n + 16 > room.size()) {
    std::vector<double> old(begin, begin + used);
    const std::size_t before = used;
    assign(2 * (used + n));
    std::copy(old.begin(), old.end(), begin);
    used = before;
  }
  std::copy(row, row + n, begin + used);
  used += n;
}

}    // namespace mdanim
