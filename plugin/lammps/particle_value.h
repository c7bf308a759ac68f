// SPDX-License-Identifier: GPL-2.0-only
// A style's argument that is one number for all particles or, as d_NAME, a custom property of each particle.

#pragma once

#include "pointers.h"

#include <string>

namespace mdanim {

class ParticleValue {
 public:
  ParticleValue() = default;
  // `what` names the argument in messages, e.g. "fix mdanim/wall: k"; `iarg` is its place, for the caret.
  ParticleValue(LAMMPS_NS::LAMMPS *lmp, const char *what, int iarg, const char *word);

  bool constant() const { return name.empty(); }
  // Looks the property up again (it may have moved). Raises a LAMMPS error when it is gone or holds a negative value.
  void init(LAMMPS_NS::LAMMPS *lmp);
  // Values of all local particles, or nullptr when constant; valid until particles are added or moved.
  const double *values(LAMMPS_NS::LAMMPS *lmp) const;
  double number = 0.0;

 private:
  std::string what, name;
  int index = -1;
};

// A style's argument that is a table of whole numbers of each particle, i2_NAME, or none.
class ParticleTable {
 public:
  ParticleTable() = default;
  ParticleTable(LAMMPS_NS::LAMMPS *lmp, const char *what, int iarg, const char *word);

  bool given() const { return !name.empty(); }
  int width(LAMMPS_NS::LAMMPS *lmp) const;    // number of its columns; 0 when there is no such table
  int *const *rows(LAMMPS_NS::LAMMPS *lmp) const;
  bool ghosts_have_rows(LAMMPS_NS::LAMMPS *lmp) const;
  std::string name;    // without i2_
};

// A style's argument that is a custom property of each particle, d_NAME, which the style itself writes, or none.
class ParticleColumn {
 public:
  ParticleColumn() = default;
  // Raises a LAMMPS error when there is no such property, like values().
  ParticleColumn(LAMMPS_NS::LAMMPS *lmp, const char *style, const char *keyword, int iarg, const char *word);

  bool given() const { return !name.empty(); }
  double *values(LAMMPS_NS::LAMMPS *lmp) const;    // of all local particles

 private:
  std::string style, keyword, name;
};

// Mass of a local particle: its own where particles have one, else that of its type.
inline double mass_of(const double *rmass, const double *mass, const int *type, int i)
{ return rmass ? rmass[i] : mass[type[i]]; }

}    // namespace mdanim
