// SPDX-License-Identifier: GPL-2.0-only
// The particles of rigid bodies: the place of each in its body.

#pragma once

#include "lammps/whole_objects.h"
#include "rigid/body.h"

#include <vector>

namespace mdanim {

class RigidParticles : public WholeObjects {
 public:
  // Takes the objects of the group of a fix.
  RigidParticles(LAMMPS_NS::LAMMPS *lmp, const LAMMPS_NS::Fix &fix);
  ~RigidParticles() override;
  RigidParticles(const RigidParticles &) = delete;
  RigidParticles &operator=(const RigidParticles &) = delete;

  Vec3 own(int i) const { return vec3(own_place[i]); }
  void set_own(int i, const Vec3 &place);

  // Sets the places of particles in bodies from their places in space.
  void fix_places(const std::vector<RigidBody> &bodies);
  // Sets velocities of particles, and places as well if bodies have moved. `settled`: also of bodies that sleep, where they are.
  void put(const std::vector<RigidBody> &bodies, bool places, bool settled = true) const;
  // Whether particles are elsewhere, or have other velocities, than points of their bodies; of this rank.
  struct BodyChanges {
    bool moved = false, pushed = false;
  };
  BodyChanges changes(const std::vector<RigidBody> &bodies) const;
  double bytes() const;

  // Places in the body go with particles from rank to rank.
  void grow(int n);
  void copy(int from, int to) const;
  void clear(int i) const;
  int pack(int i, double *buffer) const;
  int unpack(int i, const double *buffer) const;

 private:
  double **own_place = nullptr;    // along the axes of the body, from its centre
};

}    // namespace mdanim
