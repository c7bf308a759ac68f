// SPDX-License-Identifier: GPL-2.0-only
// Solids as samples on the grid of fix mdanim/liquid.

#include "styles/fix_mdanim_liquid.h"

#include "laws/vec3.h"

#include "atom.h"
#include "error.h"

#include <algorithm>
#include <limits>

using namespace LAMMPS_NS;
using namespace mdanim;

// Bodies that never move (or all others), as far as they reach below a height.
Basin::AddBodies FixMdanimLiquid::bodies(bool still) const
{
  const bool by_cells = lattice_cells.given() && model != Model::PAPER;
  return [=](Occupancy &into, double below) {
    if (by_cells)
      add_lattice_cells(into, still, below);
    else
      add_particles(into, still, below);
  };
}

void FixMdanimLiquid::add_particles(Occupancy &into, bool still, double below) const
{
  for (int i = 0; i < atom->nlocal; ++i) {
    const int mask = atom->mask[i];
    if (!(mask & groupbit) || static_cast<bool>(mask & still_bit) != still) continue;
    const Vec3 place = basin->in_cells(atom->x[i]);
    if (place.z <= below) into.add_particle(place);
  }
}

void FixMdanimLiquid::add_lattice_cells(Occupancy &into, bool still, double below) const
{
  const int *mask = atom->mask;
  int *const *corners = lattice_cells.rows(lmp);
  const bool knows_layers = lattice_cells.width(lmp) == 8;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(mask[i] & groupbit) || corners[i][0] == 0) continue;
    int at[8] = {i};
    int all = mask[i];
    for (int k = 0; k < 7; ++k) {
      at[k + 1] = atom->map(corners[i][k]);
      if (at[k + 1] < 0)
        error->one(FLERR,
                   "{}: particle {}, a corner of the lattice cell of particle {}, is out of reach; raise comm_modify cutoff",
                   name(), corners[i][k], atom->tag[i]);
      all &= mask[at[k + 1]];
    }
    if (static_cast<bool>(all & still_bit) != still) continue;
    Vec3 corner[8];
    double bottom = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 8; ++k) {
      corner[k] = basin->in_cells(atom->x[at[k]]);
      bottom = std::min(bottom, corner[k].z);
    }
    if (bottom > below) continue;
    if (!basin->is_smooth())
      into.add_cell(corner);
    else if (!knows_layers || !into.fill_inside(corner, corners[i][7]))
      into.spread_cell(corner);
  }
  if (!basin->is_smooth() || still) return;
  const double *const soft = softness.given() ? softness.values(lmp) : nullptr;
  const double pressure = buoyancy->density() * basin->g * basin->shape.cell.z;    // of a cell of liquid
  const double base = basin->shape.cell.x * basin->shape.cell.y * basin->shape.cell.z;
  const double liquid = buoyancy->density() * basin->cell_volume();
  for (int i = 0; i < atom->nlocal; ++i)
    if (mask[i] & groupbit && !(mask[i] & still_bit)) {
      const Vec3 place = basin->in_cells(atom->x[i]);
      if (place.z <= below)
        into.add_mass(place, mass_of(atom->rmass, atom->mass, atom->type, i) / liquid, soft ? soft[i] * pressure / base : 0.0,
                      atom->v[i][2] / basin->speed_of_waves());
    }
}
