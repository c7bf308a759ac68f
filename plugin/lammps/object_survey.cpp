// SPDX-License-Identifier: GPL-2.0-only
// Each rank surveys its own particles; data of the lowest tag win.

#include "lammps/object_survey.h"

#include "lammps/rank_gather.h"

#include "atom.h"
#include "lammps.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <mpi.h>

using namespace LAMMPS_NS;

namespace mdanim {

// Masses of objects by their molecule ID, over those particles of all ranks for which is_among(i) is true. They are summed as
// whole multiples of 2^-32 of the object's heaviest particle, so that the sum is the same on any number of ranks.
static std::map<int, double> object_masses(const Atom *atom, MPI_Comm world, const std::function<bool(int)> &is_among)
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

std::vector<SurveyedObject> survey_objects(LAMMPS *lmp, int groupbit, int excepted_bit, const MaterialValues &values,
                                           const std::function<bool(int)> &is_among)
{
  const Atom *const atom = lmp->atom;
  const auto &[kind, young, friction] = values;
  constexpr auto none = [](int id) { return SurveyedObject{id, 0, MAXTAGINT, 0, 0, 0, 0, 0, 0}; };
  const double *kinds = kind.values(lmp), *youngs = young.values(lmp), *frictions = friction.values(lmp);
  std::map<int, SurveyedObject> here;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!is_among(i)) continue;
    const int object_id = static_cast<int>(atom->molecule[i]);
    SurveyedObject &one = here.emplace(object_id, none(object_id)).first->second;
    ++one.particles;
    if (atom->mask[i] & groupbit) one.moves = 1;
    if (atom->mask[i] & excepted_bit) ++one.excepted;
    if (atom->tag[i] >= one.lowest) continue;
    one.lowest = atom->tag[i];
    one.kind = kinds ? kinds[i] : kind.number;
    one.young = youngs ? youngs[i] : young.number;
    one.friction = frictions ? frictions[i] : friction.number;
  }
  std::vector<SurveyedObject> mine_only;
  for (const auto &[object_id, one] : here) mine_only.push_back(one);
  std::map<int, SurveyedObject> joined;
  for (const SurveyedObject &one : gather(lmp->world, mine_only)) {
    SurveyedObject &total = joined.emplace(one.id, none(one.id)).first->second;
    const long long particles = total.particles + one.particles, excepted = total.excepted + one.excepted;
    const int moves = total.moves | one.moves;
    if (one.lowest < total.lowest) total = one;
    total.particles = particles, total.excepted = excepted, total.moves = moves;
  }
  const std::map<int, double> masses = object_masses(atom, lmp->world, is_among);
  std::vector<SurveyedObject> all;
  for (auto &[object_id, one] : joined) {
    one.mass = masses.at(object_id);
    all.push_back(one);
  }
  return all;
}

}    // namespace mdanim
