// SPDX-License-Identifier: GPL-2.0-only
// Forces that early participants of passes give, in rows of blocks.

#pragma once

#include "geometry/aligned_array.h"
#include "passes/force_provider.h"
#include "passes/pass.h"
#include "passes/pass_participant.h"
#include "passes/plane_blocks.h"

#include <vector>

namespace mdanim {

class ExternalForces {
 public:
  explicit ExternalForces(int lanes) : lanes(lanes), at_planes(lanes) {}

  // Sets the particles of each participant, for which it gives forces before every pass, and its points at planes, whose contacts
  // passes compute; in the order in which forces are added. Some particles may be ghosts.
  void expect(const std::vector<std::vector<int>> &particles, const PlaneBlocks::OfProviders &points, std::vector<Block> &all,
              const PlaneBlocks::Where &where);
  // For participant number n, its particles in the same order: their places, those of ghosts from an array of LAMMPS; and where
  // forces on them are added up, which is zero after every pass for all particles that it moves.
  void tell_places(const Threads &threads, std::size_t n, const double *const *x, const double *const *of_ghosts,
                   Positions &to) const
  { providers[n].tell_places(threads, x, of_ghosts, to); }
  ForceSums of(std::size_t n) { return {given.data(), providers[n].slot.data(), lanes}; }
  const PlaneBlocks &planes() const { return at_planes; }

  void fill(Pass &pass, double dt);
  std::size_t bytes() const;

 private:
  const int lanes;
  std::vector<ForceProvider> providers;
  Doubles given;    // see Pass::external_force
  PlaneBlocks at_planes;
};

}    // namespace mdanim
