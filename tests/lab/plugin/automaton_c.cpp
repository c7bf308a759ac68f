// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions over the automaton, for ctypes: tests and benchmarks. Arrays are (nz, ny, nx) without the rim.

#include "c_api/abi.h"
#include "c_api/guarded.h"
#include "liquid/automaton/automaton.h"
#include "liquid/automaton/automaton_rules.h"
#include "numbers/counter_rng.h"

#include <cstdint>

using mdanim::Automaton;
using mdanim::Cells;
using mdanim::guarded;
using mdanim::Vertical;

namespace mdanim {

// Inside of an automaton, as far as tests need it.
struct AutomatonProbe {
  Automaton &a;

  // Whether a sweep is known to change nothing. False may also be said of a grid that happens to rest.
  bool at_rest()
  {
    for (int z = 0; z < a.cells.nz; ++z) {
      if (!a.layers[z].known) a.look(z);
      if (a.mixes(a.layers[z]) || (z > 0 && a.exchanges(a.layers[z - 1], a.layers[z]))) return false;
    }
    return true;
  }

  // The cells of a sweep, written as the rules read.
  void plain_sweep(std::uint64_t when)
  {
    permute(a.even, draw_key(a.seed, when, Phase::EVEN_BLOCKS));
    exchange(0);
    permute(a.odd, draw_key(a.seed, when, Phase::ODD_BLOCKS));
    exchange(1);
    a.poured();
  }

 private:
  void permute(const Automaton::Blocks &blocks, std::uint64_t key)
  {
    Cells &cells = a.cells;
    for (int z = 0; z < cells.nz; ++z)
      for (int by = 0; by < blocks.ny; ++by)
        for (int bx = 0; bx < blocks.nx; ++bx) {
          const std::size_t place = cells.at(blocks.first + 2 * bx, blocks.first + 2 * by, z);
          const std::uint32_t word = draw32(key, blocks.word(blocks.block(bx, by), z));
          const int draw = word >> 2 * (z % LAYERS_PER_WORD) & 3;
          permute_block(&cells.content[place], cells.row, horizontal_rule(open_corners(&cells.open[place], cells.row), draw));
        }
  }

  // The vertical rule, eq. (4.16), for a cell and the one above it: how many units come down (-1, 0 or 1).
  int vertical_rule(int lower, int upper) const
  {
    if (upper > 0 && lower == 0) return 1;
    if (lower > 1 && upper < (a.vertical == Vertical::LOWER ? lower : Cells::FULLEST)) return -1;
    return 0;
  }

  void exchange(int first)
  {
    Cells &cells = a.cells;
    for (int z = first; z + 1 < cells.nz; z += 2)
      for (int y = 0; y < cells.ny; ++y)
        for (int x = 0; x < cells.nx; ++x) {
          const std::size_t lower = cells.at(x, y, z), upper = cells.at(x, y, z + 1);
          if (!cells.open[lower] || !cells.open[upper]) continue;
          const int down = vertical_rule(cells.content[lower], cells.content[upper]);
          cells.content[lower] += down;
          cells.content[upper] -= down;
        }
  }
};

}    // namespace mdanim

static Automaton &automaton(void *a) { return *static_cast<Automaton *>(a); }

// Null, with a message, where there is no memory for it.
MDANIM_EXPORT void *mdanim_automaton_new(int nx, int ny, int nz, std::uint64_t seed, int any_vertical, char *error,
                                         int error_size)
{
  Automaton *made = nullptr;
  guarded(error, error_size, [&] { made = new Automaton(nx, ny, nz, seed, any_vertical ? Vertical::ANY : Vertical::LOWER); });
  return made;
}

MDANIM_EXPORT void mdanim_automaton_free(void *a) { delete &automaton(a); }

// Automata that share whatever they can.
MDANIM_EXPORT void mdanim_automaton_threads(void *a, int threads) { automaton(a).use(mdanim::Threads(threads)); }

MDANIM_EXPORT void mdanim_automaton_sweep(void *a, std::uint64_t when, int count)
{
  for (int n = 0; n < count; ++n) automaton(a).sweep(when + n);
}

MDANIM_EXPORT void mdanim_automaton_plain_sweep(void *a, std::uint64_t when)
{ mdanim::AutomatonProbe{automaton(a)}.plain_sweep(when); }

MDANIM_EXPORT int mdanim_automaton_at_rest(void *a) { return mdanim::AutomatonProbe{automaton(a)}.at_rest(); }

// Returns how many cells changed, or -1 with a message.
MDANIM_EXPORT long mdanim_automaton_displace(void *a, const std::uint8_t *solid, std::uint64_t when, char *error, int error_size)
{
  long changed = -1;
  guarded(error, error_size, [&] { changed = automaton(a).displace(solid, when); });
  return changed;
}

// Returns how many units found no room, or -1 with a message.
MDANIM_EXPORT long mdanim_automaton_fill(void *a, long units, const std::uint8_t *within, std::uint64_t when, char *error,
                                         int error_size)
{
  long left = -1;
  guarded(error, error_size, [&] { left = automaton(a).fill(units, within, when); });
  return left;
}

MDANIM_EXPORT long mdanim_automaton_total(void *a) { return automaton(a).total(); }

MDANIM_EXPORT long mdanim_automaton_count_solid(void *a) { return automaton(a).count_solid(); }

MDANIM_EXPORT void mdanim_automaton_get(void *a, std::uint8_t *content)
{
  const Cells &cells = automaton(a).cells;
  cells.each([&](int x, int y, int z) { *content++ = cells.content[cells.at(x, y, z)]; });
}

MDANIM_EXPORT void mdanim_automaton_set(void *a, const std::uint8_t *content)
{
  Cells &cells = automaton(a).cells;
  cells.each([&](int x, int y, int z) { cells.content[cells.at(x, y, z)] = *content++; });
  automaton(a).poured();
}

// 0 open, 1 solid, 2 solid and still.
MDANIM_EXPORT void mdanim_automaton_solid(void *a, std::uint8_t *solid)
{
  const Cells &cells = automaton(a).cells;
  cells.each([&](int x, int y, int z) {
    const std::size_t place = cells.at(x, y, z);
    *solid++ = cells.open[place] ? 0 : cells.still[place] ? 2 : 1;
  });
}
