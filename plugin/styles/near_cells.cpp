// SPDX-License-Identifier: GPL-2.0-only

#include "styles/near_cells.h"

#include "atom.h"
#include "error.h"
#include "fmt/format.h"

namespace mdanim {

void NearCells::find(const std::vector<int> &near, const ParticleTable &table, const std::string &fix)
{
  cells.clear();
  of_particle.assign(8 * near.size(), -1);
  number.assign(atom->nlocal, -1);
  for (std::size_t n = 0; n < near.size(); ++n) number[near[n]] = static_cast<int>(n);
  int *const *corners = table.rows(lmp);
  const bool knows_layers = table.width(lmp) == 8;
  for (int i = 0; i < atom->nlocal + atom->nghost; ++i) {
    if (corners[i][0] == 0) continue;
    Cell cell{{atom->map(atom->tag[i])}, knows_layers ? corners[i][7] : -1};
    bool any = false;
    int lost = -1;
    for (int k = 0; k < 8; ++k) {
      if (k > 0) cell.corner[k] = atom->map(corners[i][k - 1]);
      const int at = cell.corner[k];
      if (at < 0) lost = k;
      any = any || (at >= 0 && at < atom->nlocal && number[at] >= 0);
    }
    if (!any) continue;
    if (lost >= 0)
      error->one(FLERR, "{}: particle {}, a corner of the lattice cell of particle {}, is out of reach; raise comm_modify cutoff",
                 fix, corners[i][lost - 1], atom->tag[i]);
    for (int k = 0; k < 8; ++k)
      if (const int at = cell.corner[k]; at < atom->nlocal && number[at] >= 0)
        of_particle[8 * number[at] + k] = static_cast<int>(cells.size());
    cells.push_back(cell);
  }
}

}    // namespace mdanim
