// SPDX-License-Identifier: GPL-2.0-only
// Loops over particles and lattice cells.

#include "lammps/solid_samples.h"

#include "numbers/vec3.h"

#include "atom.h"
#include "comm.h"
#include "error.h"

#include <algorithm>
#include <array>
#include <limits>

using namespace LAMMPS_NS;

namespace mdanim {

static constexpr const char *STYLE = "fix mdanim/liquid";
static constexpr double UNYIELDING = 1e3;    // mass of what is driven as the liquid feels it, over its own

std::vector<Keyword> SolidSamples::keywords(bool &changed)
{
  return {{"cells", "i2_NAME", "",
           [&, this](int at, char **arg) {
             cells = ParticleTable(lmp, "fix mdanim/liquid: cells", at + 1, arg[at + 1]);
             changed = true;
           }},
          {"softness", "d_NAME", "",
           [&, this](int at, char **arg) {
             softness = ParticleColumn(lmp, STYLE, arg[at], at + 1, arg[at + 1]);
             changed = true;
           }},
          {"still", "GROUP", "",
           [&, this](int at, char **arg) {
             still_group = NamedGroup(lmp, STYLE, at + 1, arg[at + 1]);
             changed = true;
           }},
          {"driven", "GROUP", "", [&, this](int at, char **arg) {
             driven_group = NamedGroup(lmp, STYLE, at + 1, arg[at + 1]);
             changed = true;
           }}};
}

void SolidSamples::init(bool by_the_paper, const std::string &name)
{
  literal = by_the_paper;
  fix = name;
  if (!cells.given()) return;
  const int width = cells.width(lmp);
  if (width != 7 && width != 8)
    error->all(
        FLERR,
        "{}: cells names i2_{}, which is not a property of 7 integers, or 8 with the layers of cells around it; make it with "
        "'fix ID all property/atom i2_{} 7 ghost yes'",
        fix, cells.name, cells.name);
  if (comm->nprocs > 1 && !cells.ghosts_have_rows(lmp))
    error->all(FLERR,
               "{}: ghosts have no rows of i2_{}, which cells needs on several ranks; add 'ghost yes' to its fix property/atom",
               fix, cells.name);
}

bool SolidSamples::is_still(int i) const { return !none_is_still && (atom->mask[i] & still_group.bit()) != 0; }

Basin::AddBodies SolidSamples::bodies(const Basin &basin, bool still)
{
  return [=, this, &basin](Occupancy &into, double below) {
    std::vector<int> these;
    for (int i = 0; i < atom->nlocal; ++i)
      if (atom->mask[i] & group && is_still(i) == still) these.push_back(i);
    if (!by_cells()) return add_particles(into, basin, these, below);
    NearCells of_these(lmp);
    of_these.find(threads, these, cells, fix);
    add_bodies(into, basin, these, of_these, still, below);
  };
}

Basin::AddBodies SolidSamples::bodies_near(const Basin &basin, const std::vector<int> &near)
{
  return [this, &basin, &near](Occupancy &into, double below) {
    if (by_cells())
      add_bodies(into, basin, near, buoyancy.lattice_cells(), false, below);
    else
      add_particles(into, basin, near, below);
  };
}

// Row of cells at a place along y [distance], the last one up to the far wall; any row where the place is outside or not a
// number.
int SolidSamples::row_at(const Basin &basin, double y) const
{
  const double row = (y - basin.low().y) / basin.shape.cell.y;
  return row > 0.0 ? static_cast<int>(std::min(row, basin.shape.ny - 1.0)) : 0;
}

void SolidSamples::add_particles(Occupancy &into, const Basin &basin, const std::vector<int> &these, double below) const
{
  for (const int i : these) {
    const Vec3 place = basin.in_cells(atom->x[i]);
    if (place.z <= below) into.add_particle(place);
  }
}

// Adds bodies by their lattice cells, of which this rank has the first corner. A cell never moves if all its corners are still.
void SolidSamples::add_bodies(Occupancy &into, const Basin &basin, const std::vector<int> &these, const NearCells &with,
                              bool still, double below)
{
  constexpr double CELL = 150.0;    // [ns], approximately
  const double *const *x = atom->x;
  const bool smooth = basin.is_smooth();
  const auto is_still = [this](int i) { return this->is_still(i); };
  const auto row_of = [&](long n) {
    const int *const corner = with.cells[n].corner;
    return row_at(basin, 0.5 * (x[corner[0]][1] + x[corner[6]][1]));
  };
  struct alignas(64) Reached {    // so that threads do not write into the same cache line
    CellBox box;
  };
  std::vector<Reached> reached(RowSlabs::slabs_of(basin.shape.ny));
  const auto add = [&](long n, const RowSlabs::Rows &rows, int slab) {
    const NearCells::Cell &cell = with.cells[n];
    if (cell.corner[0] >= atom->nlocal) return true;
    if (std::all_of(cell.corner, cell.corner + 8, is_still) != still) return true;
    std::array<Vec3, 8> corner;
    double bottom = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 8; ++k) {
      corner[k] = basin.in_cells(x[cell.corner[k]]);
      bottom = std::min(bottom, corner[k].z);
    }
    return bottom > below || into.add(corner.data(), smooth, cell.layers, rows, reached[slab].box);
  };
  slabs.each(threads, basin.shape.ny, static_cast<long>(with.cells.size()), CELL, row_of, add);
  for (const Reached &of_slab : reached) into.touched.take_in(of_slab.box);
  if (smooth && !still) add_mass(into, basin, these, below);
}

void SolidSamples::add_mass(Occupancy &into, const Basin &basin, const std::vector<int> &these, double below)
{
  constexpr double PARTICLE = 20.0;    // [ns], approximately
  const double *const soft = softness.given() ? softness.values(lmp) : nullptr;
  const double pressure = buoyancy.density() * buoyancy.weight(basin) * basin.shape.cell.z;    // of a cell of liquid
  const double base = basin.shape.cell.x * basin.shape.cell.y * basin.shape.cell.z;
  const int unyielding = driven_group.bit() | (none_is_still ? still_group.bit() : 0);
  const double liquid = buoyancy.density() * basin.cell_volume();
  const auto row_of = [&](long n) { return row_at(basin, atom->x[these[n]][1]); };
  if (!these.empty()) into.begin_mass();
  slabs.each(threads, basin.shape.ny, static_cast<long>(these.size()), PARTICLE, row_of,
             [&](long n, const RowSlabs::Rows &, int) {
               const int i = these[n];
               const Vec3 place = basin.in_cells(atom->x[i]);
               const bool driven = (atom->mask[i] & unyielding) != 0;
               if (place.z <= below)
                 into.add_mass(place, (driven ? UNYIELDING : 1.0) * mass_of(atom->rmass, atom->mass, atom->type, i) / liquid,
                               soft && !driven ? soft[i] * pressure / base : 0.0, atom->v[i][2] / basin.speed_of_waves());
               return true;
             });
}

}    // namespace mdanim
