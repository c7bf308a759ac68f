// SPDX-License-Identifier: GPL-2.0-only
// Contacts of one field, four at a time: the interface to the vector code (contact_kernel_of_set.cpp). Plain data only;
// simd/of_set.h says why.

#pragma once

#include "contact/contact_judge.h"
#include "contact/contact_push.h"
#include "contact/field_contact.h"
#include "contact/padded_vec3.h"
#include "contact/plane_contact.h"
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

// Looks at points without a contact that few steps of Newton's method find from where they were: points of objects with one body
// in hosts with one body.
struct LookTask {
  Lattice host;
  const PaddedVec3 *place;    // as that of Placed
  double steep;               // as that of pressed(), of the host
  Ramps ramps;
  bool is_smooth;    // the map
  BodyCarriers carriers;
  const PointFacing *facing;    // of each point
  double radius;                // of the surface around each point [m]; such points have no normals
  int row, layer;               // of the grid of the objects whose points these are
  double spacing, own_steep;
  bool is_rigid;    // these objects
};

// A point and X of it, in a cell, where it was found last.
struct PointBefore {
  int point, cell[3];
  PaddedVec3 X;
  const int *slot, *own_slot;    // as those of PushTask and PointsTask
  const Spot<double> *rigid;     // X = 0 of a rigid object whose point it is
};

struct LookedBlock {
  int sure;                       // one bit for each lane: no contact begins
  double slack[CONTACT_LANES];    // motions that cannot yet begin a contact [m]
  PaddedVec3 x[CONTACT_LANES], X[CONTACT_LANES];
  int cell[CONTACT_LANES][3];
};

// Contacts with a plane across an axis; `sign` is 1 where objects belong above it.
struct PlaneTask {
  ContactLaw law;
  double dt;
  int axis;
  double sign, at;    // where it is at the start [m]
  Vec3 shift;         // its displacement since then [m]
  double radius;      // of the surface around each point [m]
  PointsTask points;
};

// Particles of an object that go from `last` to places in arrays of all x, all y, all z, which become rows: those from `first` to
// `end` - 1.
struct MoveTask {
  const double *const *to;
  int first, end;
  const PaddedVec3 *last;    // may be `now`
  PaddedVec3 *now;
  Vec3 about;    // a displacement
};

// The mean of their displacements, and the square of the largest one relative to `about`.
struct MovedBy {
  Vec3 mean;
  double square;
};

struct ContactKernels {
  MovedBy (*move)(const MoveTask &);
  // Places of the points of the first `n` contacts from `first` on.
  void (*find_points)(const PointsTask &, const FieldContact *first, int n, PointNow *now);
  // Computes the first `n` of the contacts from `first` on, all of points of one kind; those in `hard` stay as they are.
  void (*push)(const PushTask &, FieldContact *first, const PointNow *now, int n, PushedBlock &pushed);
  // Computes `n` contacts from `first` on.
  void (*push_at_plane)(const PlaneTask &, PlaneContact *first, int n, PlanePush<double> *pushed);
  // Adds the forces of these contacts on the particles that carry their points.
  void (*add_at_plane)(const PointsTask &, const PlaneContact *first, int n, const PlanePush<double> *pushed, PaddedVec3 *on);
  // Looks at the first `n` of the points from `first` on.
  void (*look)(const LookTask &, const PointBefore *first, int n, LookedBlock &looked);
  // Adds the forces of lanes from `first` to `end` - 1 on the host's nodes.
  void (*add_to_nodes)(const PushedBlock &pushed, int first, int end, PaddedVec3 *on);
  // Adds the forces of these lanes on the particles that carry their points; `contacts` are those of the block.
  void (*add_to_points)(const PointsTask &, const FieldContact *contacts, const PushedBlock &pushed, int first, int end,
                        PaddedVec3 *on);
};

}    // namespace mdanim
