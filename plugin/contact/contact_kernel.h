// SPDX-License-Identifier: GPL-2.0-only
// Contacts of one field, four at a time: the interface to the vector code (contact_kernel_of_set.cpp). Plain data only;
// simd/of_set.h says why.

#pragma once

#include "contact/contact_push.h"
#include "contact/field_contact.h"
#include "contact/padded_vec3.h"
#include "contact/point_carriers.h"
#include "contact/rigid_map.h"

namespace mdanim {

// Gathering and scattering take most of the time: eight lanes would not be faster.
constexpr int CONTACT_LANES = 4;

// The point of a contact as it is now.
template <class Real> struct PointOf {
  Vec<Real> x, shift;    // in space; from the point to the centre of its area
  Real area;
};
using PointNow = PointOf<double>;

struct PushTask {
  ContactLaw law;
  double dt;
  Lattice host;
  const int *slot;            // numbers of the host's particles by their places in the grid
  const PaddedVec3 *place;    // as that of Placed
  double longest;             // depth beyond which a contact is over [m]
  Ramps ramps;
  bool is_smooth;               // the map
  const RigidFrame *frame;      // of a host that does not deform, else null: its particles have the numbers `slot`,
  const Spot<double> *rigid;    // and X = 0 is here
  bool takes_force;             // a rigid host
  double radius;                // of the surface around each point [m]
};

// Results for a contact in a step, besides the values that it keeps.
template <class Real> struct PushedContact {
  Vec<Real> at_centre;    // force there
  Real heat, damped;      // [J]
  Real work;              // of surfaces that run [J]
};

// Results for up to four contacts. Values of a lane in `hard` are wrong: its contact is over, or needs a search.
struct PushedBlock {
  int hard, on_ramp;    // one bit for each lane; there is a force at the centre
  PushedContact<double> contact[CONTACT_LANES];
  FieldContact unused;                // values that lanes in `hard` would keep
  const int *slots[CONTACT_LANES];    // numbers of the host's nodes, from the first on
  int nodes;
  long step[27];    // from the first node to this one
  PaddedVec3 on_node[27][CONTACT_LANES];
};

// The object whose points are in contact.
struct PointsTask {
  BodyCarriers carriers;
  const double *area;         // of each point
  const int *slot;            // numbers of its particles, by those of carriers
  const PaddedVec3 *place;    // as that of Placed
};

struct ContactKernels {
  // Places of the points of the first `n` contacts from `first` on.
  void (*find_points)(const PointsTask &, const FieldContact *first, int n, PointNow *now);
  // Computes the first `n` of the contacts from `first` on, all of points of one kind; those in `hard` stay as they are.
  void (*push)(const PushTask &, FieldContact *first, const PointNow *now, int n, PushedBlock &pushed);
  // Adds the forces of lanes from `first` to `end` - 1 on the host's nodes.
  void (*add_to_nodes)(const PushedBlock &pushed, int first, int end, PaddedVec3 *on);
  // Adds the forces of these lanes on the particles that carry their points; `contacts` are those of the block.
  void (*add_to_points)(const PointsTask &, const FieldContact *contacts, const PushedBlock &pushed, int first, int end,
                        PaddedVec3 *on);
};

}    // namespace mdanim
