// SPDX-License-Identifier: GPL-2.0-only
// Rows for forces of participants.

#include "passes/external_forces.h"

namespace mdanim {

// Gives blocks with a particle of any provider a row for each provider.
void ExternalForces::expect(const std::vector<std::vector<int>> &particles, const PlaneBlocks::OfProviders &points,
                            std::vector<Block> &all, const PlaneBlocks::Where &where)
{
  const int many = static_cast<int>(particles.size());
  for (Block &block : all) block.external_force = -1;
  providers.assign(many, {});
  int rows = 1;    // the first is for forces on ghosts
  for (int n = 0; n < many; ++n)
    for (const int i : particles[n]) {
      ForceProvider &provider = providers[n];
      const PlaneBlocks::Lane at = where(i);
      if (at.block < 0) {
        provider.ghosts.push_back({i, static_cast<int>(provider.slot.size())});
        provider.particle.push_back(0);
        provider.slot.push_back(0);
        continue;
      }
      Block &block = all[at.block];
      provider.particle.push_back(block.start + at.lane);
      if (block.external_force < 0) {
        block.external_force = rows;
        rows += many;
      }
      provider.slot.push_back(static_cast<long>(block.external_force + n) * 3 * lanes + at.lane);
    }
  for (ForceProvider &provider : providers) provider.find_rows();
  given.assign(static_cast<std::size_t>(rows) * 3 * lanes);
  at_planes.take_in(points, all, where);
}

void ExternalForces::fill(Pass &pass, double dt)
{
  pass.external_force = given.data();
  pass.force_providers = static_cast<int>(providers.size());
  pass.planes = at_planes.filled(dt);
}

std::size_t ExternalForces::bytes() const
{
  std::size_t sum = given.bytes() + at_planes.bytes();
  for (const ForceProvider &b : providers)
    sum += b.particle.capacity() * sizeof(int) + b.ghosts.capacity() * sizeof(ForceProvider::Ghost) +
           b.slot.capacity() * sizeof(long) + b.in_row.capacity() * sizeof(b.in_row[0]);
  return sum;
}

}    // namespace mdanim
