// SPDX-License-Identifier: GPL-2.0-only
// The automaton's horizontal rule on a single 2x2 block. Wcislo 1999, sec. 4; docs/physics-liquid.md.

#pragma once

#include <array>
#include <cstdint>
#include <utility>

namespace mdanim {

constexpr int LAYERS_PER_WORD = 16;    // of 32 bits, two for each layer

// The corner of its 2x2 block from which each corner takes its content; in ring order (0,0) (1,0) (1,1) (0,1).
using Sources = std::array<std::uint8_t, 4>;

// The horizontal rule for a block: `open` has a bit for each open corner, `draw` is 0 … 3. It permutes open cells only. The
// permutation does not depend on contents, so every arrangement stays as likely as any other.
inline Sources horizontal_rule(int open, int draw)
{
  int ring[4], n = 0;
  for (int corner = 0; corner < 4; ++corner)
    if (open >> corner & 1) ring[n++] = corner;
  Sources from = {0, 1, 2, 3};
  const auto swap = [&](int a, int b) { std::swap(from[a], from[b]); };
  if (n == 2) {
    if (draw >= 2 && (ring[1] - ring[0]) % 2) swap(ring[0], ring[1]);
  } else if (n > 2) {
    if (draw == 1 && n == 4) {
      swap(0, 2);
      swap(1, 3);
    } else if (draw == 1) {
      const int solid = 6 - ring[0] - ring[1] - ring[2];
      swap((solid + 1) % 4, (solid + 3) % 4);
    } else if (draw >= 2) {
      const int step = draw == 2 ? 1 : n - 1;
      for (int k = 0; k < n; ++k) from[ring[(k + step) % n]] = ring[k];
    }
  }
  return from;
}

// Moves the contents of the block whose first corner is *a.
inline void permute_block(std::uint8_t *a, int row, const Sources &from)
{
  const std::uint8_t was[4] = {a[0], a[1], a[row + 1], a[row]};
  a[0] = was[from[0]];
  a[1] = was[from[1]];
  a[row + 1] = was[from[2]];
  a[row] = was[from[3]];
}

inline int open_corners(const std::uint8_t *a, int row) { return (a[0] & 1) | (a[1] & 2) | (a[row + 1] & 4) | (a[row] & 8); }

}    // namespace mdanim
