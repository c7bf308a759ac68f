// SPDX-License-Identifier: GPL-2.0-only
// A plain C function over the liquid that moves with bodies, for tests. Columns are (ny, nx).

#include "c_api/abi.h"
#include "liquid/waves/added_mass.h"

#include <cstring>

using mdanim::AddedMass;

// `depths`: below and above; `bottoms`: heights of the lower faces; `solids`: mass and velocity; `state`: mass, force and
// velocity, which is brought up to date.
MDANIM_EXPORT void mdanim_added_mass(int nx, int ny, const double *depths, const double *bottoms, const double *solids,
                                     double since, double *state)
{
  AddedMass added(nx, ny);
  std::vector<AddedMass::Depths> of_liquid(nx * ny);
  std::vector<AddedMass::Solids> moving(nx * ny);
  std::vector<int> with;
  for (int c = 0; c < nx * ny; ++c) {
    of_liquid[c] = {depths[2 * c], depths[2 * c + 1], bottoms[c]};
    moving[c] = {solids[2 * c], solids[2 * c + 1]};
    if (moving[c].mass > 0.0) with.push_back(c);
  }
  const std::size_t bytes = added.state().size() * sizeof(AddedMass::Column);
  std::memcpy(added.state().data(), state, bytes);
  if (since > 0.0)
    added.follow(with, of_liquid.data(), moving.data(), since);
  else
    added.start(with, of_liquid.data(), moving.data());
  std::memcpy(state, added.state().data(), bytes);
}
