// SPDX-License-Identifier: GPL-2.0-only
// The styles of the tests, as a plugin of their own: tests/lab/plugin_library.py builds it.

#include "c_api/abi.h"
#include "fix_mdanim_test_memory.h"
#include "fix_mdanim_test_rig.h"

#include "lammps.h"

using namespace LAMMPS_NS;

template <class Style> static void *make(void *lmp, int narg, char **arg)
{ return new Style(static_cast<LAMMPS *>(lmp), narg, arg); }

MDANIM_EXPORT void lammpsplugin_init(void *lmp, void *handle, void *register_style)
{
  const auto add = [&](const char *name, const char *what, auto maker) {
    mdanim::PluginRecord style{static_cast<LAMMPS *>(lmp)->version, "fix", name, what, "mdanim-lammps", {}, handle};
    style.creator.with_arguments = maker;
    reinterpret_cast<mdanim::Register>(register_style)(&style, lmp);
  };
  add("mdanim/test/memory", "forces that depend on history", &make<FixMdanimTestMemory>);
  add("mdanim/test/rig", "all that a feature may do", &make<FixMdanimTestRig>);
}
