// SPDX-License-Identifier: GPL-2.0-only

#include "lammps/bent_rings.h"

#include "lammps/fix_mdanim_tear.h"
#include "lammps/shared_file.h"

#include "atom.h"
#include "error.h"
#include "update.h"

#include <algorithm>
#include <stdexcept>

using namespace LAMMPS_NS;

namespace mdanim {

void BentRings::read(const char *file)
{
  try {
    objects = read_bends(file, read_shared_file(lmp, who.c_str(), "rings", file));
  } catch (const std::runtime_error &wrong) {
    error->all(FLERR, "{}: {}", who, wrong.what());
  }
  for (const auto &[molecule, own] : objects)
    for (const BendRing &ring : own) rings.push_back({&ring, molecule});
  if (rings.empty()) error->all(FLERR, "{}: there is no ring in {}; write object MOLECULE, and its rings and lines", who, file);
}

// Lowest tags of objects, the property, and which rings have which links.
void BentRings::init()
{
  int is_double = 0, columns = 0, needed = 0;
  for (const OwnRing &one : rings) needed = std::max(needed, one.of->slot + static_cast<int>(one.of->lines.size()));
  property = atom->find_custom(property_name.c_str(), is_double, columns);
  if (property < 0 || !is_double || columns < needed)
    error->all(FLERR,
               "{}: there is no per-particle property d2_{} {}; make it with 'fix ID all property/atom d2_{} {} ghost yes'", who,
               property_name, needed, property_name, needed);
  for (const auto &[molecule, own] : objects) lowest[molecule] = MAXTAGINT;
  for (int i = 0; i < atom->nlocal; ++i)
    if (const auto found = lowest.find(static_cast<int>(atom->molecule[i])); found != lowest.end())
      found->second = std::min(found->second, atom->tag[i]);
  for (auto &[molecule, tag] : lowest) {
    MPI_Allreduce(MPI_IN_PLACE, &tag, 1, MPI_LMP_TAGINT, MPI_MIN, world);
    if (tag == MAXTAGINT) error->all(FLERR, "{}: there is no object {} (molecule ID)", who, molecule);
  }
  tears = FixMdanimTear::of(lmp);
  if (!tears || !of_link.empty()) return;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const std::vector<int> &of = rings[r].of->of;
    for (std::size_t a = 0; a < of.size(); ++a)
      for (std::size_t b = a + 1; b < of.size(); ++b) of_link[{rings[r].molecule, std::minmax(of[a], of[b])}].push_back(r);
  }
}

// Rings with a link that has gone since the last look, ascending.
std::vector<std::size_t> BentRings::newly_gone()
{
  std::vector<std::size_t> found;
  for (; tears && known < tears->gone().size(); ++known) {
    const GoneLink &link = tears->gone()[known];
    const auto own = of_link.find({link.object, {link.low, link.high}});
    if (own == of_link.end()) continue;
    for (const std::size_t r : own->second)
      if (!rings[r].is_gone) {
        rings[r].is_gone = true;
        found.push_back(r);
      }
  }
  std::sort(found.begin(), found.end());
  return found;
}

void BentRings::begin()
{
  known = 0;
  for (OwnRing &one : rings) one.is_gone = false;
  newly_gone();    // before this run
}

void BentRings::watch(int groupbit)
{
  watched.clear();
  for (std::size_t r = 0; r < rings.size(); ++r) {
    SeenRing one{r, {}, {}};
    bool is_here = false;
    for (const int particle : rings[r].of->of) {
      const int i = atom->map(lowest[rings[r].molecule] + particle);
      one.row.push_back(i);
      is_here = is_here || (i >= 0 && i < atom->nlocal && atom->mask[i] & groupbit);
    }
    if (!is_here || rings[r].is_gone) continue;
    if (std::find(one.row.begin(), one.row.end(), -1) != one.row.end())
      error->one(FLERR,
                 "{}: particles of the ring around particle {} are too far away from each other to be known; the lists of "
                 "LAMMPS are too old, or comm_modify cutoff is too short",
                 who, lowest[rings[r].molecule] + rings[r].of->of[0]);
    one.force.resize(one.row.size());
    watched.push_back(std::move(one));
  }
}

double *BentRings::bent_of(const SeenRing &one) const { return atom->darray[property][one.row[0]] + shape(one).slot; }

// Places of the particles of a ring, a time before.
void BentRings::places(const SeenRing &one, double before)
{
  x.resize(one.row.size());
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = vec3(atom->x[one.row[k]]) - before * vec3(atom->v[one.row[k]]);
}

void BentRings::find_force(SeenRing &one)
{
  const double *const bent = bent_of(one);
  std::fill(one.force.begin(), one.force.end(), Vec3());
  if (std::any_of(bent, bent + shape(one).lines.size(), [](double b) { return b != 0.0; }))
    BendShape(shape(one), x).push(bent, 1.0, one.force);
}

void BentRings::look()
{
  for (SeenRing &one : watched) {
    places(one, 0.0);
    find_force(one);
  }
}

// Takes what lines were bent by more into the account. x has the places of the ring.
void BentRings::release(const SeenRing &one, const std::vector<double> &less, double lost, SpringLosses &losses)
{
  now.assign(one.row.size(), Vec3());
  then = now;
  BendShape(shape(one), x).push(less.data(), 1.0, now);
  places(one, update->dt);
  BendShape(shape(one), x).push(less.data(), 1.0, then);
  for (std::size_t k = 0; k < now.size(); ++k) losses.count(one.row[k], k == 0 ? lost : 0.0, now[k], then[k]);
}

void BentRings::yield(SpringLosses &losses)
{
  const std::vector<std::size_t> gone = newly_gone();
  std::vector<double> less;
  for (SeenRing &one : watched) {
    const BendRing &ring = shape(one);
    double *const bent = bent_of(one);
    places(one, 0.0);
    if (std::binary_search(gone.begin(), gone.end(), one.ring)) {
      less.assign(bent, bent + ring.lines.size());
      release(one, less, BendShape(ring, x).energy(bent), losses);
      continue;
    }
    less.clear();
    const BendShape at(ring, x);
    for (std::size_t l = 0; l < ring.lines.size(); ++l) {
      const BendLine &line = ring.lines[l];
      const double next = mdanim::bent(at.curvature(line), bent[l], line.most);
      if (next == bent[l]) continue;
      if (less.empty()) less.assign(bent, bent + ring.lines.size());
      bent[l] = next;
    }
    if (!less.empty()) {
      const double lost = at.energy(less.data()) - at.energy(bent);
      for (std::size_t l = 0; l < less.size(); ++l) less[l] -= bent[l];
      release(one, less, lost, losses);
      places(one, 0.0);
    }
    find_force(one);
  }
  if (!gone.empty())
    watched.erase(std::remove_if(watched.begin(), watched.end(), [this](const SeenRing &one) { return rings[one.ring].is_gone; }),
                  watched.end());
}

void BentRings::push() const
{
  for (const SeenRing &one : watched)
    for (std::size_t k = 0; k < one.row.size(); ++k)
      if (one.row[k] < atom->nlocal) add_to(atom->f[one.row[k]], one.force[k]);
}

double BentRings::energy() const
{
  double here = 0.0;
  std::vector<Vec3> at;
  for (const SeenRing &one : watched) {
    if (one.row[0] >= atom->nlocal) continue;
    at.clear();
    for (const int i : one.row) at.push_back(vec3(atom->x[i]));
    here += BendShape(shape(one), at).energy(bent_of(one));
  }
  return here;
}

std::size_t BentRings::bytes() const
{
  std::size_t found = watched.capacity() * sizeof(SeenRing);
  for (const SeenRing &one : watched) found += one.row.size() * (sizeof(int) + sizeof(Vec3));
  for (const OwnRing &one : rings)
    found += sizeof one + one.of->of.size() * sizeof(int) + one.of->lines.size() * sizeof(BendLine);
  return found;
}

}    // namespace mdanim
