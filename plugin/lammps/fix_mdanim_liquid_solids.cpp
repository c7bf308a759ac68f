// SPDX-License-Identifier: GPL-2.0-only
// Solids as samples on the grid of fix mdanim/liquid.

#include "lammps/fix_mdanim_liquid.h"

#include "numbers/vec3.h"

#include "atom.h"

#include <algorithm>
#include <array>
#include <limits>

using namespace LAMMPS_NS;
using namespace mdanim;

// Bodies that never move (or all others), as far as they are below a height.
Basin::AddBodies FixMdanimLiquid::bodies(bool still)
{
  return [=](Occupancy &into, double below) {
    const std::vector<int> these = particles_of(still);
    if (!by_cells()) return add_particles(into, these, below);
    NearCells cells(lmp);
    cells.find(threads, these, lattice_cells, name());
    add_bodies(into, these, cells, still, below);
  };
}

// Bodies that may move, of which all parts that are below such a height have been listed.
Basin::AddBodies FixMdanimLiquid::bodies_near()
{
  return [=](Occupancy &into, double below) {
    if (by_cells())
      add_bodies(into, near, buoyancy->lattice_cells(), false, below);
    else
      add_particles(into, near, below);
  };
}

std::vector<int> FixMdanimLiquid::particles_of(bool still) const
{
  std::vector<int> found;
  for (int i = 0; i < atom->nlocal; ++i)
    if (atom->mask[i] & groupbit && static_cast<bool>(atom->mask[i] & still_group.bit()) == still) found.push_back(i);
  return found;
}

// Row of cells at a place along y [distance], the last one up to the far wall; any row where the place is outside or not a
// number.
int FixMdanimLiquid::row_at(double y) const
{
  const double row = (y - basin->shape.low.y) / basin->shape.cell.y;
  return row > 0.0 ? static_cast<int>(std::min(row, basin->shape.ny - 1.0)) : 0;
}

void FixMdanimLiquid::add_particles(Occupancy &into, const std::vector<int> &these, double below) const
{
  for (const int i : these) {
    const Vec3 place = basin->in_cells(atom->x[i]);
    if (place.z <= below) into.add_particle(place);
  }
}

// Adds bodies by their lattice cells, of which this rank has the first corner. A cell never moves if all its corners are still.
void FixMdanimLiquid::add_bodies(Occupancy &into, const std::vector<int> &these, const NearCells &cells, bool still, double below)
{
  constexpr double CELL = 150.0;    // [ns], approximately
  const double *const *x = atom->x;
  const bool smooth = basin->is_smooth();
  const auto is_still = [this](int i) { return (atom->mask[i] & still_group.bit()) != 0; };
  const auto row_of = [&](long n) {
    const int *const corner = cells.cells[n].corner;
    return row_at(0.5 * (x[corner[0]][1] + x[corner[6]][1]));
  };
  struct alignas(64) Reached {    // so that threads do not write into the same cache line
    CellBox box;
  };
  std::vector<Reached> reached(RowSlabs::slabs_of(basin->shape.ny));
  const auto add = [&](long n, const RowSlabs::Rows &rows, int slab) {
    const NearCells::Cell &cell = cells.cells[n];
    if (cell.corner[0] >= atom->nlocal) return true;
    if (std::all_of(cell.corner, cell.corner + 8, is_still) != still) return true;
    std::array<Vec3, 8> corner;
    double bottom = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 8; ++k) {
      corner[k] = basin->in_cells(x[cell.corner[k]]);
      bottom = std::min(bottom, corner[k].z);
    }
    return bottom > below || into.add(corner.data(), smooth, cell.layers, rows, reached[slab].box);
  };
  slabs.each(threads, basin->shape.ny, static_cast<long>(cells.cells.size()), CELL, row_of, add);
  for (const Reached &of_slab : reached) into.touched.take_in(of_slab.box);
  if (smooth && !still) add_mass(into, these, below);
}

void FixMdanimLiquid::add_mass(Occupancy &into, const std::vector<int> &these, double below)
{
  constexpr double PARTICLE = 20.0;    // [ns], approximately
  const double *const soft = softness.given() ? softness.values(lmp) : nullptr;
  const double pressure = buoyancy->density() * buoyancy->weight(*basin) * basin->shape.cell.z;    // of a cell of liquid
  const double base = basin->shape.cell.x * basin->shape.cell.y * basin->shape.cell.z;
  const double liquid = buoyancy->density() * basin->cell_volume();
  const auto row_of = [&](long n) { return row_at(atom->x[these[n]][1]); };
  if (!these.empty()) into.begin_mass();
  slabs.each(threads, basin->shape.ny, static_cast<long>(these.size()), PARTICLE, row_of,
             [&](long n, const RowSlabs::Rows &, int) {
               const int i = these[n];
               const Vec3 place = basin->in_cells(atom->x[i]);
               if (place.z <= below)
                 into.add_mass(place, mass_of(atom->rmass, atom->mass, atom->type, i) / liquid,
                               soft ? soft[i] * pressure / base : 0.0, atom->v[i][2] / basin->speed_of_waves());
               return true;
             });
}
