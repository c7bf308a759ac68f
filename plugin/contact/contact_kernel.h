// SPDX-License-Identifier: GPL-2.0-only
// Contacts of one field, four at a time: what the vector code (contact_kernel_of_set.cpp) is given and answers. Plain data alone,
// for the reason told in engine/kernels_of_set.cpp.

#ifndef MDANIM_CONTACT_KERNEL_H
#define MDANIM_CONTACT_KERNEL_H

#include "contact/contact_push.h"
#include "contact/field_contact.h"

namespace mdanim {

// Gathering and scattering set the pace: of eight lanes none would be faster.
constexpr int CONTACT_LANES = 4;

// The point of a contact as it is now.
struct PointNow {
  Vec3 x, shift;    // in space; from the point to the centre of its area
  double area;
};

struct PushTask {
  ContactLaw law;
  double dt;
  Lattice host;
  const int *slot;    // of the host's particles by their places in the grid
  const Vec3 *place;
  double longest;    // depth beyond which a contact is over [m]
  Ramps ramps;
  bool is_smooth;    // the map
};

struct VecLanes {
  double x[CONTACT_LANES], y[CONTACT_LANES], z[CONTACT_LANES];
  MDANIM_ALWAYS_INLINE Vec3 of(int lane) const { return {x[lane], y[lane], z[lane]}; }
};

// Of up to four contacts. What is told of a lane in `hard` is wrong: its contact is over, or needs a search.
struct PushedBlock {
  int hard, outside, on_ramp;    // one bit for each lane; X is out of its cell; there is a force at the centre
  VecLanes X, change, anchor, pull, drag, force, moved, at_centre;
  double offset[CONTACT_LANES], depth[CONTACT_LANES], stick[CONTACT_LANES], stick_energy[CONTACT_LANES], energy[CONTACT_LANES],
      heat[CONTACT_LANES], damped[CONTACT_LANES], damping[CONTACT_LANES];
  int nodes;    // of the host
  int slot[27][CONTACT_LANES];
  VecLanes on_node[27];
};

struct ContactKernels {
  const char *name;    // as those of engine/kernels.h
  // The first `n` of the contacts from `first` on, all of points of one kind.
  void (*push)(const PushTask &, const FieldContact *first, const PointNow *now, int n, PushedBlock &pushed);
};

// Those of a set of instructions that runs here; those of all processors for a name that is not known.
const ContactKernels &contact_kernels(const char *name);

}    // namespace mdanim

#endif
