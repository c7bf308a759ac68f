// SPDX-License-Identifier: GPL-2.0-only
// The materials of objects, from their particles.

#pragma once

#include "lammps/particle_value.h"

#include "lmptype.h"

#include <functional>
#include <vector>

namespace mdanim {

// An object's data from its particle with the lowest tag, known to all ranks; `mass` is that of all its particles.
struct SurveyedObject {
  int id, moves;    // whether some particle is in the group that moves
  LAMMPS_NS::tagint lowest;
  long long particles, excepted;    // number of all, and of those in the group that is excepted
  double kind, young, friction, mass;
};

struct MaterialValues {
  const ParticleValue &kind, &young, &friction;
};

// Called by all ranks together: the objects of the particles for which is_among(i), by ascending IDs; the same on all ranks.
std::vector<SurveyedObject> survey_objects(LAMMPS_NS::LAMMPS *lmp, int groupbit, int excepted_bit, const MaterialValues &values,
                                           const std::function<bool(int)> &is_among);

}    // namespace mdanim
