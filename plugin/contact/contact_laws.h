// SPDX-License-Identifier: GPL-2.0-only
// The law of a contact, from the materials of objects.

#pragma once

#include "contact/contact_object.h"
#include "contact/law.h"
#include "contact/plane_field.h"

#include <map>
#include <set>
#include <utility>
#include <vector>

namespace mdanim {

// Friction and damping of a pair of objects, in place of those of their materials.
struct PairLaw {
  double friction, damping;
};

struct ContactSettings {
  bool objects = false;      // whether they touch each other
  double stiffness = 1.0;    // f
  double damping = 0.0;      // beta of pairs with friction
  std::vector<ContactPlane> planes;
  std::map<std::pair<int, int>, PairLaw> pairs;    // by ids, the lower one first
  std::set<std::pair<int, int>> excluded;          // the same, of pairs that never touch
  std::map<int, Vec3> belts;                       // by ids: velocities at which surfaces run over objects that stand [m/s]
  Vec3 belt(int id) const
  {
    const auto found = belts.find(id);
    return found == belts.end() ? Vec3{} : found->second;
  }

  // Law for points of an object against another one; `density` is that of the lighter one that can move, because that one swings.
  ContactLaw law_of_pair(const ContactObject &owner, const ContactObject &host, double density) const;
  ContactLaw law_at_plane(const ContactObject &one) const;
};

}    // namespace mdanim
