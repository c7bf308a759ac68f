// SPDX-License-Identifier: GPL-2.0-only
// The styles of the tests, as a plugin of their own: tests/lab/plugin_library.py builds it.

#include "c_api/abi.h"
#include "fix_mdanim_test_memory.h"

#include "lammps.h"

using namespace LAMMPS_NS;

static void *make_memory(void *lmp, int narg, char **arg)
{ return new FixMdanimTestMemory(static_cast<LAMMPS *>(lmp), narg, arg); }

MDANIM_EXPORT void lammpsplugin_init(void *lmp, void *handle, void *register_style)
{
  mdanim::PluginRecord style{static_cast<LAMMPS *>(lmp)->version,
                             "fix",
                             "mdanim/test/memory",
                             "forces that depend on history",
                             "mdanim-lammps",
                             {},
                             handle};
  style.creator.with_arguments = &make_memory;
  reinterpret_cast<mdanim::Register>(register_style)(&style, lmp);
}
