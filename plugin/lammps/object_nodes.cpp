// SPDX-License-Identifier: GPL-2.0-only

#include "lammps/object_nodes.h"

#include "lammps/particle_value.h"

#include "atom.h"
#include "error.h"

#include <algorithm>
#include <mpi.h>

using namespace LAMMPS_NS;

namespace mdanim {

int ObjectNodes::object_of(int i) const
{
  const auto found = std::lower_bound(objects.begin(), objects.end(), atom->molecule[i],
                                      [](const OneObject &one, tagint id) { return one.molecule < id; });
  return found != objects.end() && found->molecule == atom->molecule[i] ? static_cast<int>(found - objects.begin()) : ELSEWHERE;
}

std::vector<tagint> ObjectNodes::lowest_tags() const
{
  std::vector<tagint> lowest(objects.size(), MAXTAGINT);
  for (int i = 0; i < atom->nlocal; ++i)
    if (const int n = object_of(i); n != ELSEWHERE) lowest[n] = std::min(lowest[n], atom->tag[i]);
  MPI_Allreduce(MPI_IN_PLACE, lowest.data(), static_cast<int>(lowest.size()), MPI_LMP_TAGINT, MPI_MIN, world);
  return lowest;
}

// Each mass is of one rank, so that sums are the numbers themselves.
void ObjectNodes::find_masses(const std::string &who, const std::vector<tagint> &lowest)
{
  std::size_t all = 0;
  for (OneObject &one : objects) {
    one.first = all;
    all += one.particles->size();
  }
  masses.assign(all, 0.0);
  for (int i = 0; i < atom->nlocal; ++i) {
    const int n = object_of(i);
    if (n == ELSEWHERE) continue;
    const std::vector<int> &nodes = *objects[n].particles;
    const auto found = std::lower_bound(nodes.begin(), nodes.end(), atom->tag[i] - lowest[n]);
    if (found != nodes.end() && *found == atom->tag[i] - lowest[n])
      masses[objects[n].first + (found - nodes.begin())] = mass_of(atom->rmass, atom->mass, atom->type, i);
  }
  MPI_Allreduce(MPI_IN_PLACE, masses.data(), static_cast<int>(masses.size()), MPI_DOUBLE, MPI_SUM, world);
  for (int n = 0; n < count(); ++n) {
    if (lowest[n] == MAXTAGINT) error->all(FLERR, "{}: there is no object {} (molecule ID)", who, molecule(n));
    for (std::size_t k = first(n); k < end(n); ++k)
      if (masses[k] == 0.0)
        error->all(FLERR, "{}: object {} (molecule ID) has no particle {}, counted from its lowest tag, 1", who, molecule(n),
                   (*objects[n].particles)[k - first(n)] + 1);
  }
}

void ObjectNodes::find(const std::string &who)
{
  const std::vector<tagint> lowest = lowest_tags();
  find_masses(who, lowest);
  std::vector<tagint> tags;
  for (std::size_t n = 0; n < objects.size(); ++n)
    for (const int node : *objects[n].particles) tags.push_back(lowest[n] + node);
  std::vector<tagint> ascending = tags;
  std::sort(ascending.begin(), ascending.end());
  shared.choose(std::move(ascending));
  number.clear();
  for (const tagint tag : tags) number.push_back(shared.number_of(tag));
}

void ObjectNodes::locate(const std::string &who, int groupbit)
{
  shared.locate(who, groupbit);
  row.resize(number.size());
  targets.resize(number.size());
  for (int n = 0; n < count(); ++n) {
    objects[n].acts = false;
    for (std::size_t k = first(n); k < end(n); ++k) {
      row[k] = shared.row_of(number[k]);
      targets[k] = shared.is_pushed(number[k]) ? shared.local(number[k]) : ELSEWHERE;
      objects[n].acts = objects[n].acts || shared.is_pushed(number[k]);
    }
  }
}

std::size_t ObjectNodes::bytes() const
{
  return shared.bytes() + masses.capacity() * sizeof(double) +
         (number.capacity() + row.capacity() + targets.capacity()) * sizeof(int);
}

}    // namespace mdanim
