// SPDX-License-Identifier: GPL-2.0-only
// Rows from bonds.

#include "lammps/bond_rows.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "update.h"

#include <algorithm>
#include <utility>

using namespace LAMMPS_NS;

namespace mdanim {

// Whether tags or bonds differ from those that the rows were made from, which are then stored. During a run only fixes change
// bonds; except for fixes of the bond/ family every change shows in the number of a particle's bonds.
bool BondRows::source_changed(bool partners_may_differ)
{
  const int nlocal = atom->nlocal;
  if (given) {
    if (nlocal != rows.size() || atom->nghost || !std::is_sorted(atom->tag, atom->tag + nlocal))
      error->all(FLERR,
                 "bond_style mdanim/harmonic: springs were given for {} particles, in the order of their tags and without "
                 "ghosts; at step {} there are {}, with {} ghosts, or in another order; if the bodies fly apart, lower the "
                 "time step",
                 rows.size(), update->ntimestep, nlocal, atom->nghost);
    return false;
  }
  bool same = atom->nghost == 0 && static_cast<int>(source.tag.size()) == nlocal &&
              std::equal(source.tag.begin(), source.tag.end(), atom->tag) &&
              std::equal(source.count.begin(), source.count.end(), atom->num_bond);
  SpringRows::Row row;
  for (int i = 0; same && partners_may_differ && i < nlocal; ++i) same = !has_changed(i, row);
  if (same) return false;

  source = Source();
  if (atom->nghost) return true;    // indices of ghosts change with every rebuild
  source.tag.assign(atom->tag, atom->tag + nlocal);
  source.count.assign(atom->num_bond, atom->num_bond + nlocal);
  return true;
}

bool BondRows::has_changed(int i, SpringRows::Row &row) const
{
  look_up(i, upper_only, row);
  return !rows.is(i, row);
}

bool BondRows::update_rows(bool partners_may_differ)
{
  if (!source_changed(partners_may_differ)) return false;
  const bool halves = halves_suffice();
  SpringRows now(atom->nlocal);
  SpringRows::Row row;
  for (int i = 0; i < atom->nlocal; ++i) {
    look_up(i, halves, row);
    now.add(row);
  }
  adopt(std::move(now), halves);
  return true;
}

void BondRows::take(SpringRows &&upper_rows)
{
  given = true;
  adopt(std::move(upper_rows), true);
}

void BondRows::adopt(SpringRows &&now, bool halves)
{
  now.close();
  rows = std::move(now);
  upper_only = halves;
  farthest_offset = 0;
  for (int i = 0; halves && i < rows.size(); ++i)
    if (rows[i].size()) farthest_offset = std::max(farthest_offset, rows[i].first->offset);
}

void BondRows::lost_partner(int i, int partner) const
{
  if (i < 0)
    error->one(FLERR,
               "bond_style mdanim/harmonic: bonds to particle {} were changed without a setup; leave out 'pre no' of this run, "
               "which is at step {}",
               partner, update->ntimestep);
  error->one(FLERR,
             "bond_style mdanim/harmonic: particle {} has lost its bond partner {} at step {}; if the "
             "bodies move as they should, raise the ghost cutoff ('comm_modify cutoff'); if they fly apart, "
             "lower the time step",
             atom->tag[i], partner, update->ntimestep);
}

// The bonds of particle i in the order in which their forces are summed: lower partners from the lowest tag up, which may be left
// out, then upper ones from the highest down.
void BondRows::look_up(int i, bool halves, SpringRows::Row &row) const
{
  const bool periodic = domain->xperiodic || domain->yperiodic || domain->zperiodic;
  const tagint *const tag = atom->tag, own = tag[i];
  std::vector<SpringRows::Link> &link = row.link;
  link.clear();
  tagint before = 0;
  bool ascending = true;
  for (int b = 0; b < atom->num_bond[i]; ++b) {
    const tagint other = atom->bond_atom[i][b];
    const int type = atom->bond_type[i][b];
    if (type <= 0 || (halves && other < own)) continue;    // 0 and less: switched off by delete_bonds
    int partner = atom->map(other);
    if (partner < 0) lost_partner(i, other);
    if (periodic) partner = domain->closest_image(i, partner);
    link.push_back({partner - i, type});
    ascending = ascending && other > before;
    before = other;
  }
  const auto tag_of = [tag, i](const SpringRows::Link &l) { return tag[i + l.offset]; };
  if (!ascending) std::stable_sort(link.begin(), link.end(), [&](const auto &a, const auto &b) { return tag_of(a) < tag_of(b); });
  const auto upper = std::find_if(link.begin(), link.end(), [&](const auto &l) { return tag_of(l) > own; });
  row.lower = static_cast<int>(upper - link.begin());
  std::reverse(upper, link.end());
  for (auto several = link.begin(); several != upper;) {    // several bonds between the same two: in the same order at both ends
    const auto end = std::find_if(several, upper, [&](const auto &l) { return l.offset != several->offset; });
    std::reverse(several, end);
    several = end;
  }
}

// With particles in tag order and all partners here, the lower partners of a row come before it.
bool BondRows::halves_suffice() const
{
  const int nlocal = atom->nlocal;
  if (!std::is_sorted(atom->tag, atom->tag + nlocal)) return false;
  SpringRows::Row row;
  for (int i = 0; atom->nghost && i < nlocal; ++i) {
    look_up(i, false, row);
    if (std::any_of(row.link.begin(), row.link.end(), [=](const auto &l) { return i + l.offset >= nlocal; })) return false;
  }
  return true;
}

}    // namespace mdanim
