/* SPDX-License-Identifier: GPL-2.0-only */

#pragma once

#include "lammps/particle_value.h"
#include "lammps/rank_gather.h"

#include "atom.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <mpi.h>
#include <vector>

namespace mdanim {

// Masses of objects by their molecule ID, over those particles of all ranks for which is_among(i) is true. They are summed as
// whole multiples of 2^-32 of the object's heaviest particle, so that the sum is the same on any number of ranks.
template <class IsAmong> std::map<int, double> object_masses(const LAMMPS_NS::Atom *atom, MPI_Comm world, const IsAmong &is_among)
{
  constexpr double UNITS = 4294967296.0;
  struct Weight {
    int id;
    double heaviest;
    std::int64_t units;
  };
  std::map<int, Weight> here, all;
  const auto each = [&](const auto &add) {
    for (int i = 0; i < atom->nlocal; ++i) {
      if (!is_among(i)) continue;
      const int id = static_cast<int>(atom->molecule[i]);
      add(here.emplace(id, Weight{id, 0.0, 0}).first->second, mass_of(atom->rmass, atom->mass, atom->type, i));
    }
  };
  const auto of_all_ranks = [&](const auto &add) {
    std::vector<Weight> mine;
    for (const auto &[id, one] : here) mine.push_back(one);
    for (const Weight &one : gather(world, mine)) add(all.emplace(one.id, Weight{one.id, 0.0, 0}).first->second, one);
  };
  each([](Weight &one, double mass) { one.heaviest = std::max(one.heaviest, mass); });
  of_all_ranks([](Weight &total, const Weight &one) { total.heaviest = std::max(total.heaviest, one.heaviest); });
  each([&](Weight &one, double mass) { one.units += std::llround(mass / all.at(one.id).heaviest * UNITS); });
  of_all_ranks([](Weight &total, const Weight &one) { total.units += one.units; });
  std::map<int, double> masses;
  for (const auto &[id, one] : all) masses[id] = one.heaviest / UNITS * static_cast<double>(one.units);
  return masses;
}

}    // namespace mdanim
