// SPDX-License-Identifier: GPL-2.0-only
// A class without a header cannot be measured with sizeof: its constructor and its init() are watched instead.

#include "lammps/checked_verlet.h"

#include "domain.h"
#include "error.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <new>

using namespace LAMMPS_NS;

// The library's table of virtual functions: two words, two destructors, then functions in the order of their declaration.
extern "C" const void *const verlet_table[] __asm__("_ZTVN9LAMMPS_NS6VerletE");

namespace {

constexpr int WORDS_AHEAD = 2, DESTRUCTORS = 2, FUNCTIONS = 8;
constexpr std::size_t MARGIN = 1024;    // bytes behind the object
constexpr unsigned char FILL = 0xa5;

// Overrides nothing: its table has, in the order of our declaration, the library's functions.
class Probe final : public Verlet {
 public:
  using Verlet::Verlet;

  bool lists_are_empty() const
  {
    constexpr unsigned char EMPTY[sizeof unused_lists] = {};    // three null pointers each
    return std::memcmp(static_cast<const void *>(unused_lists), EMPTY, sizeof EMPTY) == 0;
  }
};

const void *const *table_of(const Probe *probe)
{
  const void *const *table;
  std::memcpy(&table, static_cast<const void *>(probe), sizeof table);
  return table;
}

}    // namespace

bool LAMMPS_NS::verlet_is_as_declared(LAMMPS *lmp)
{
  alignas(Probe) unsigned char room[sizeof(Probe) + MARGIN];
  std::memset(room, FILL, sizeof room);
  __asm__ volatile("" : : "r"(room) : "memory");    // the compiler must assume that the fill is read
  auto *const probe = new (room) Probe(lmp, 0, nullptr);
  const void *const *const declared = table_of(probe) + DESTRUCTORS, *const *const found =
                                                                         verlet_table + WORDS_AHEAD + DESTRUCTORS;
  const bool found_all = std::equal(declared, declared + FUNCTIONS, found) && probe->lists_are_empty();
  const bool stays_inside = std::all_of(room + sizeof(Probe), std::end(room), [](unsigned char byte) { return byte == FILL; });
  probe->~Probe();
  return found_all && stays_inside;
}

CheckedVerlet::CheckedVerlet(LAMMPS *lmp, int narg, char **arg) : Verlet(lmp, narg, arg)
{ std::fill(std::begin(behind), std::end(behind), UNTOUCHED); }

void CheckedVerlet::init()
{
  triclinic = torqueflag = extraflag = -1;
  Verlet::init();
  const auto is_flag = [](int value) { return value == 0 || value == 1; };
  const bool written = triclinic == domain->triclinic && is_flag(torqueflag) && is_flag(extraflag);
  if (!written || std::any_of(std::begin(behind), std::end(behind), [](std::uint64_t word) { return word != UNTOUCHED; }))
    error->all(FLERR, "run_style verlet/mdanim: run_style verlet of this LAMMPS has another layout than that for which "
                      "mdanimplugin.so was built: reinstall mdanim-lammps beside this LAMMPS");
}
