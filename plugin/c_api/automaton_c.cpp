// SPDX-License-Identifier: GPL-2.0-only
// Plain C functions over the automaton, for ctypes: tests and benchmarks. Arrays are (nz, ny, nx) without the
// rim. No exception leaves them.

#include "c_api/abi.h"
#include "liquid/automaton.h"

#include <cstdio>
#include <exception>

using namespace mdanim;

namespace {

Automaton &automaton(void *a) { return *static_cast<Automaton *>(a); }

// Calls visit(place, number) for every cell but the rim.
template <class Visit> void every_cell(const Cells &cells, Visit visit)
{
  std::size_t number = 0;
  for (int z = 0; z < cells.nz; ++z)
    for (int y = 0; y < cells.ny; ++y)
      for (int x = 0; x < cells.nx; ++x) visit(cells.at(x, y, z), number++);
}

}    // namespace

MDANIM_EXPORT void *mdanim_automaton_new(int nx, int ny, int nz, std::uint64_t seed, int any_vertical)
{ return new Automaton(nx, ny, nz, seed, any_vertical ? Vertical::ANY : Vertical::LOWER); }

MDANIM_EXPORT void mdanim_automaton_free(void *a) { delete &automaton(a); }

// Name of the instruction set, or a null pointer where this processor lacks it.
MDANIM_EXPORT const char *mdanim_automaton_use(void *a, int instruction_set)
{ return automaton(a).use_instruction_set(instruction_set); }

MDANIM_EXPORT void mdanim_automaton_sweep(void *a, std::uint64_t when, int count)
{
  for (int n = 0; n < count; ++n) automaton(a).sweep(when + n);
}

MDANIM_EXPORT void mdanim_automaton_plain_sweep(void *a, std::uint64_t when) { automaton(a).plain_sweep(when); }

MDANIM_EXPORT int mdanim_automaton_at_rest(void *a) { return automaton(a).at_rest(); }

// Returns how many cells changed, or -1 with a message.
MDANIM_EXPORT long mdanim_automaton_displace(void *a, const std::uint8_t *solid, std::uint64_t when, char *error, int error_size)
{
  try {
    return automaton(a).displace(solid, when);
  } catch (const std::exception &e) {
    std::snprintf(error, error_size, "%s", e.what());
    return -1;
  }
}

MDANIM_EXPORT long mdanim_automaton_fill(void *a, long units, const std::uint8_t *within, std::uint64_t when)
{ return automaton(a).fill(units, within, when); }

MDANIM_EXPORT long mdanim_automaton_total(void *a) { return automaton(a).total(); }

MDANIM_EXPORT long mdanim_automaton_count_solid(void *a) { return automaton(a).count_solid(); }

MDANIM_EXPORT void mdanim_automaton_get(void *a, std::uint8_t *content)
{
  const Cells &cells = automaton(a).cells;
  every_cell(cells, [&](std::size_t place, std::size_t number) { content[number] = cells.content[place]; });
}

MDANIM_EXPORT void mdanim_automaton_set(void *a, const std::uint8_t *content)
{
  Cells &cells = automaton(a).cells;
  every_cell(cells, [&](std::size_t place, std::size_t number) { cells.content[place] = content[number]; });
  automaton(a).poured();
}

// 0 open, 1 solid, 2 solid and still.
MDANIM_EXPORT void mdanim_automaton_solid(void *a, std::uint8_t *solid)
{
  const Cells &cells = automaton(a).cells;
  every_cell(cells, [&](std::size_t place, std::size_t number) {
    solid[number] = cells.open[place] ? 0 : cells.still[place] ? 2 : 1;
  });
}
