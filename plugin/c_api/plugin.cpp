// SPDX-License-Identifier: GPL-2.0-only
// Where LAMMPS enters: one row per style, registered only in the LAMMPS version whose headers we were
// compiled with.

#include "c_api/abi.h"
#include "styles/bond_mdanim_harmonic.h"
#include "styles/fix_mdanim_barrier.h"
#include "styles/fix_mdanim_gravity.h"
#include "styles/fix_mdanim_leapfrog.h"
#include "styles/fix_mdanim_liquid.h"
#include "styles/fix_mdanim_wall.h"
#include "styles/verlet_mdanim.h"

#include "comm.h"
#include "lammps.h"
#include "library.h"
#include "utils.h"

using namespace LAMMPS_NS;
using mdanim::PluginRecord;

namespace {

template <class Style> void *make_bond(void *lmp) { return new Style(static_cast<LAMMPS *>(lmp)); }

void *make_run(void *lmp, int narg, char **arg) { return new VerletMdanim(static_cast<LAMMPS *>(lmp), narg, arg); }

template <class Style> void *make_fix(void *lmp, int narg, char **arg)
{ return new Style(static_cast<LAMMPS *>(lmp), narg, arg); }

PluginRecord bond(const char *name, const char *info, void *(*creator)(void *) )
{
  PluginRecord row{nullptr, "bond", name, info, "mdanim-lammps", {}, nullptr};
  row.creator.without_arguments = creator;
  return row;
}

PluginRecord fix(const char *name, const char *info, void *(*creator)(void *, int, char **) )
{
  PluginRecord row{nullptr, "fix", name, info, "mdanim-lammps", {}, nullptr};
  row.creator.with_arguments = creator;
  return row;
}

PluginRecord run(const char *name, const char *info, void *(*creator)(void *, int, char **) )
{
  PluginRecord row{nullptr, "run", name, info, "mdanim-lammps", {}, nullptr};
  row.creator.with_arguments = creator;
  return row;
}

}    // namespace

MDANIM_EXPORT int mdanim_abi() { return mdanim::ABI; }

// The LAMMPS version whose headers we were compiled with, as lammps_version() counts.
extern "C" __attribute__((visibility("default"))) int mdanim_built_for;
int mdanim_built_for = MDANIM_LAMMPS_VERSION;

// A C++ class of another LAMMPS version may have another layout, and LAMMPS itself loads such a plugin
// without complaint.
MDANIM_EXPORT void lammpsplugin_init(void *lmp, void *handle, void *register_style)
{
  const int found = lammps_version(lmp);
  if (found != mdanim_built_for) {
    fprintf(stderr,
            "mdanimplugin.so was built for LAMMPS version %d and is not loaded into version %d: "
            "reinstall mdanim-lammps beside this LAMMPS\n",
            mdanim_built_for, found);
    return;
  }

  PluginRecord styles[] = {
      bond("mdanim/harmonic", "springs in gather form", &make_bond<BondMdanimHarmonic>),
      fix("mdanim/leapfrog", "leap-frog with friction", &make_fix<FixMdanimLeapfrog>),
      fix("mdanim/gravity", "m g on every particle", &make_fix<FixMdanimGravity>),
      fix("mdanim/barrier", "contact of objects", &make_fix<FixMdanimBarrier>),
      fix("mdanim/liquid", "liquid that solids float and sink in", &make_fix<FixMdanimLiquid>),
      fix("mdanim/wall", "walls that stand any impact", &make_fix<FixMdanimWall>),
      run("verlet/mdanim", "verlet with springs, gravity and leap-frog in one pass", &make_run),
  };
  for (PluginRecord &style : styles) {
    style.version = static_cast<LAMMPS *>(lmp)->version;
    style.handle = handle;
    reinterpret_cast<mdanim::Register>(register_style)(&style, lmp);
  }
}
