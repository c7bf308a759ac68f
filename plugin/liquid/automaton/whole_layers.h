// SPDX-License-Identifier: GPL-2.0-only
// The automaton's loops over whole layers, in a form that compilers turn into instructions for vectors.

#pragma once

#include "liquid/automaton/automaton.h"
#include "numbers/counter_rng.h"

namespace mdanim {

// Two neighbours along x, the left one in the low byte.
using Pair = std::uint16_t __attribute__((may_alias, aligned(1)));
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "pairs of cells are read as little-endian numbers");

// Contents that occur among open cells: no liquid, one unit, more than one.
enum Holds : std::uint8_t { ZERO = 1, ONE = 2, MORE = 4, ANYTHING = 7 };

namespace whole_layers {

// Draws first … first + n - 1 under a key, with their halves apart.
inline void draw_words(std::uint64_t key, std::uint32_t first, int n, std::uint16_t *__restrict low,
                       std::uint16_t *__restrict high)
{
  for (int i = 0; i < n; ++i) {
    const std::uint32_t word = draw32(key, first + i);
    low[i] = static_cast<std::uint16_t>(word);
    high[i] = static_cast<std::uint16_t>(word >> 16);
  }
}

// Quarter turns of the ring a b / d c: one if bit 1 of the draw is set, two more if bit 0 is. So 0 1 2 3 stand for no change,
// both diagonals swapped, +1, -1.
inline void permute_row(Pair *__restrict ab, Pair *__restrict dc, const Pair *__restrict open_ab, const Pair *__restrict open_dc,
                        int n, const std::uint16_t *__restrict draws, int shift)
{
  for (int i = 0; i < n; ++i) {
    const std::uint16_t whole = -((open_ab[i] & open_dc[i]) == 0xffff), draw = draws[i] >> shift;
    const std::uint16_t half = whole & -(draw & 1), quarter = whole & -(draw >> 1 & 1);    // masks
    const std::uint16_t p = ab[i], q = dc[i];
    const std::uint16_t p_turned = (q & 0x00ff) | (p << 8), q_turned = (q >> 8) | (p & 0xff00);
    const std::uint16_t r = p ^ ((p ^ p_turned) & quarter), s = q ^ ((q ^ q_turned) & quarter);
    const std::uint16_t r_turned = (s << 8) | (s >> 8), s_turned = (r << 8) | (r >> 8);
    ab[i] = r ^ ((r ^ r_turned) & half);
    dc[i] = s ^ ((s ^ s_turned) & half);
  }
}

// Permutes the blocks of a layer whose four cells are open, each by the two bits of its draw at `shift`.
inline void permute(std::uint8_t *content, const std::uint8_t *open, int row, int nx, int ny, const std::uint16_t *draws,
                    int shift)
{
  for (int by = 0; by < ny; ++by, content += 2 * row, open += 2 * row, draws += nx)
    permute_row(reinterpret_cast<Pair *>(content), reinterpret_cast<Pair *>(content + row), reinterpret_cast<const Pair *>(open),
                reinterpret_cast<const Pair *>(open + row), nx, draws, shift);
}

// Applies eq. (4.16) to n pairs of cells, one above the other. Returns whether anything changed.
template <Vertical VERTICAL>
inline bool exchange(std::uint8_t *__restrict lower, std::uint8_t *__restrict upper, const std::uint8_t *__restrict open_lower,
                     const std::uint8_t *__restrict open_upper, std::size_t n)
{
  std::uint8_t changed = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint8_t l = lower[i], u = upper[i], most = VERTICAL == Vertical::LOWER ? l : Cells::FULLEST;
    const std::uint8_t falls = l == 0 && u > 0 ? 1 : 0, rises = l > 1 && u < most ? 1 : 0;
    const std::uint8_t down = static_cast<std::uint8_t>(falls - rises) & open_lower[i] & open_upper[i];
    lower[i] = l + down;
    upper[i] = u - down;
    changed |= down;
  }
  return changed != 0;
}

// Contents of n cells, as bits of Holds.
inline std::uint8_t look(const std::uint8_t *__restrict content, const std::uint8_t *__restrict open, std::size_t n)
{
  std::uint8_t zero = 0, one = 0, more = 0;
  for (std::size_t i = 0; i < n; ++i) {
    zero |= (content[i] == 0) & open[i];
    one |= content[i] == 1;
    more |= content[i] > 1;
  }
  return zero * ZERO | one * ONE | more * MORE;
}

// Whether some of n cells differ from `solid` (0 open, 1 solid, 2 solid and still).
inline bool differ(const std::uint8_t *__restrict solid, const std::uint8_t *__restrict open,
                   const std::uint8_t *__restrict still, std::size_t n)
{
  std::uint8_t found = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint8_t opened = solid[i] == 0, stilled = solid[i] == 2;
    found |= (opened ^ (open[i] & 1)) | (stilled ^ still[i]);
  }
  return found != 0;
}

}    // namespace whole_layers

}    // namespace mdanim
