// SPDX-License-Identifier: GPL-2.0-only
// The particles that joints hold on to, found among all particles.

#pragma once

#include "joints/joint.h"

#include "lmptype.h"

#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS {
class LAMMPS;
}

namespace mdanim {

struct FoundJoints {
  std::vector<Joint> joints;
  std::vector<char> pushes;                        // whether each end has particles in the group, two for each joint
  std::map<int, LAMMPS_NS::tagint> lowest_tags;    // by molecule IDs, of objects with joints
  std::string problem;                             // why there are no joints; empty if there are
};

// "joint 3 (hinge 1 2)", for messages; n counts from 0.
std::string name_of_joint(std::size_t n, const JointWords &words);
// Called by all ranks together, and found alike on all.
FoundJoints find_joints(LAMMPS_NS::LAMMPS *lmp, int groupbit, const std::vector<JointWords> &words);

}    // namespace mdanim
