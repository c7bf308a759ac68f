// SPDX-License-Identifier: GPL-2.0-only
// The entry point for LAMMPS: one row per style, registered only in a LAMMPS that has the binary interface of the headers that
// this file was compiled with.

#include "c_api/abi.h"
#include "lammps/bond_mdanim_harmonic.h"
#include "lammps/checked_verlet.h"
#include "lammps/compute_mdanim_timestep.h"
#include "lammps/fix_mdanim_air.h"
#include "lammps/fix_mdanim_barrier.h"
#include "lammps/fix_mdanim_contact.h"
#include "lammps/fix_mdanim_drive.h"
#include "lammps/fix_mdanim_folds.h"
#include "lammps/fix_mdanim_force.h"
#include "lammps/fix_mdanim_gravity.h"
#include "lammps/fix_mdanim_hand.h"
#include "lammps/fix_mdanim_inflate.h"
#include "lammps/fix_mdanim_joint.h"
#include "lammps/fix_mdanim_leapfrog.h"
#include "lammps/fix_mdanim_liquid.h"
#include "lammps/fix_mdanim_rigid.h"
#include "lammps/fix_mdanim_tear.h"
#include "lammps/fix_mdanim_wall.h"
#include "lammps/fix_mdanim_yield.h"
#include "lammps/verlet_mdanim.h"

#include "atom.h"
#include "domain.h"
#include "fmt/format.h"
#include "force.h"
#include "lammps.h"
#include "library.h"
#include "update.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>

using namespace LAMMPS_NS;
using mdanim::PluginRecord;

namespace {

template <class Style> PluginRecord style(const char *kind, const char *name, const char *info)
{
  PluginRecord row{MDANIM_LAMMPS_DATE, kind, name, info, "mdanim-lammps", {}, nullptr};
  if constexpr (std::is_constructible_v<Style, LAMMPS *>)
    row.creator.without_arguments = [](void *lmp) -> void * { return new Style(static_cast<LAMMPS *>(lmp)); };
  else
    row.creator.with_arguments = [](void *lmp, int narg, char **arg) -> void * {
      return new Style(static_cast<LAMMPS *>(lmp), narg, arg);
    };
  return row;
}

}    // namespace

MDANIM_EXPORT int mdanim_abi() noexcept { return mdanim::ABI; }

// The LAMMPS version of the headers that the plugin was compiled with, as lammps_version() counts.
extern "C" __attribute__((visibility("default"))) int mdanim_built_for;
int mdanim_built_for = MDANIM_LAMMPS_VERSION;

namespace {

// The first line of the description that the MPI library in this process gives.
std::string name_of_mpi()
{
  char text[MPI_MAX_LIBRARY_VERSION_STRING] = "";
  int length = 0;
  MPI_Get_library_version(text, &length);
  const std::string all(text, length);
  return all.substr(0, all.find('\n'));
}

// Whether members whose addresses the library interface gives are where our headers have them: builds of one date may differ by
// updates and patches.
bool layout_is_ours(LAMMPS *lmp)
{
  const std::pair<const char *, const void *> known[] = {
      {"ntimestep", &lmp->update->ntimestep}, {"dt", &lmp->update->dt},       {"boxlo", lmp->domain->boxlo},
      {"boxhi", lmp->domain->boxhi},          {"sublo", lmp->domain->sublo},  {"natoms", &lmp->atom->natoms},
      {"nlocal", &lmp->atom->nlocal},         {"nghost", &lmp->atom->nghost}, {"ftm2v", &lmp->force->ftm2v},
      {"mvv2e", &lmp->force->mvv2e},          {"q_flag", &lmp->atom->q_flag},
  };
  return std::all_of(std::begin(known), std::end(known),
                     [lmp](const auto &member) { return lammps_extract_global(lmp, member.first) == member.second; });
}

// Why the styles cannot work in this LAMMPS; empty if they can. A C++ class of another LAMMPS may have another layout, and LAMMPS
// itself loads such a plugin without complaint. Each test relies only on what the tests before it have checked.
std::string why_not(LAMMPS *lmp)
{
  if (const int found = lammps_version(lmp); found != mdanim_built_for)
    return fmt::format("was built for LAMMPS version {} and is not loaded into version {}", mdanim_built_for, found);
  const std::pair<const char *, int> sizes[] = {
      {"bigint", sizeof(bigint)}, {"tagint", sizeof(tagint)}, {"imageint", sizeof(imageint)}};
  for (const auto &[type, size] : sizes)
    if (const int found = lammps_extract_setting(lmp, type); found != size)
      return fmt::format("was built for {} of {} bytes and is not loaded into a LAMMPS that has {} (another of SMALLSMALL, "
                         "SMALLBIG and BIGBIG)",
                         type, size, found);
  if (!lammps_config_has_mpi_support()) return "needs a LAMMPS with MPI and is not loaded into one without";
  if (!layout_is_ours(lmp))
    return fmt::format("was built for another update of LAMMPS version {}, whose classes have another layout", mdanim_built_for);
  if (!verlet_is_as_declared(lmp))
    return fmt::format("was built for another update of LAMMPS version {} or with another standard library: run_style verlet has "
                       "another layout",
                       mdanim_built_for);
  // Handles of MPICH, and of all libraries with its binary interface, are whole numbers, the same in C and in Fortran.
  if (lammps_get_mpi_comm(lmp) != static_cast<int>(lmp->world))
    return fmt::format("was built for MPICH and is not loaded into a LAMMPS with {}", name_of_mpi());
  return "";
}

}    // namespace

MDANIM_EXPORT void lammpsplugin_init(void *handle_of_lammps, void *handle, void *register_style) noexcept
{
  auto *const lmp = static_cast<LAMMPS *>(handle_of_lammps);
  if (const std::string why = why_not(lmp); !why.empty()) {
    fprintf(stderr, "mdanimplugin.so %s: reinstall mdanim-lammps beside this LAMMPS\n", why.c_str());
    return;
  }

  PluginRecord styles[] = {
      style<BondMdanimHarmonic>("bond", "mdanim/harmonic", "springs in gather form"),
      style<ComputeMdanimTimestep>("compute", "mdanim/timestep", "the largest stable time step"),
      style<FixMdanimLeapfrog>("fix", "mdanim/leapfrog", "leap-frog with friction"),
      style<FixMdanimGravity>("fix", "mdanim/gravity", "m g on every particle"),
      style<FixMdanimHand>("fix", "mdanim/hand", "hands that pull at material points of objects"),
      style<FixMdanimJoint>("fix", "mdanim/joint", "joints between objects"),
      style<FixMdanimAir>("fix", "mdanim/air", "air pushes at surfaces"),
      style<FixMdanimInflate>("fix", "mdanim/inflate", "gas in closed surfaces"),
      style<FixMdanimBarrier>("fix", "mdanim/barrier", "a barrier between objects"),
      style<FixMdanimContact>("fix", "mdanim/contact", "objects and planes touch, with friction"),
      style<FixMdanimDrive>("fix", "mdanim/drive", "what is held goes where functions of time say"),
      style<FixMdanimFolds>("fix", "mdanim/folds", "layers touch each other and themselves"),
      style<FixMdanimForce>("fix", "mdanim/force", "forces and torques on objects as a whole"),
      style<FixMdanimLiquid>("fix", "mdanim/liquid", "liquid that solids float and sink in"),
      style<FixMdanimRigid>("fix", "mdanim/rigid", "objects that do not deform"),
      style<FixMdanimTear>("fix", "mdanim/tear", "springs that break where they are stretched too far"),
      style<FixMdanimYield>("fix", "mdanim/yield", "springs whose rest length follows where they bear too much"),
      style<FixMdanimWall>("fix", "mdanim/wall", "walls that withstand any impact"),
      style<VerletMdanim>("run", "verlet/mdanim", "verlet with springs, gravity and leap-frog in one pass"),
  };
  for (PluginRecord &row : styles) {
    row.handle = handle;
    reinterpret_cast<mdanim::Register>(register_style)(&row, lmp);
  }
}
