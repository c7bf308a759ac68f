// SPDX-License-Identifier: GPL-2.0-only
// Velocities in post_force and before are those of the half step.

#include "fix_mdanim_test_rig.h"

#include "records/byte_reader.h"
#include "records/byte_writer.h"

#include "atom.h"
#include "error.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static constexpr std::int64_t STATE_VERSION = 1;
static constexpr double PI = 3.14159265358979323846;
static constexpr int TETHER_WORDS = 7;

FixMdanimTestRig::FixMdanimTestRig(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg)
{
  if (narg < 8 || (narg - 8) % TETHER_WORDS) error->all(FLERR, "fix mdanim/test/rig: see the top of its header");
  const auto number = [&](int at) { return utils::numeric(FLERR, arg[at], false, lmp); };
  const auto end = [&](int at) {
    return End{utils::tnumeric(FLERR, arg[at], false, lmp), utils::inumeric(FLERR, arg[at + 1], false, lmp)};
  };
  amplitude = {number(3), number(4), number(5)};
  frequency = number(6);
  memory = number(7);
  for (int i = 8; i < narg; i += TETHER_WORDS) tethers.push_back({end(i + 1), end(i + 3), number(i + 5), number(i + 6), {}});
  need(THREE_DIMENSIONS | OPEN_BOX | OBJECTS | ATOM_MAP);
  tell({{"work", true, [this] { return sum(work); }}, clock()});
}

int FixMdanimTestRig::setmask() { return INITIAL_INTEGRATE | POST_FORCE | END_OF_STEP; }

void FixMdanimTestRig::init() { FixBase::init(); }

double **FixMdanimTestRig::rows(const char *name) const
{
  int is_double = 0, columns = 0;
  const int index = atom->find_custom(name, is_double, columns);
  if (index < 0 || !is_double || !columns) error->all(FLERR, "fix mdanim/test/rig needs d2_{}", name);
  return atom->darray[index];
}

double *FixMdanimTestRig::values(const char *name) const
{
  int is_double = 0, columns = 0;
  const int index = atom->find_custom(name, is_double, columns);
  return index < 0 || !is_double || columns ? nullptr : atom->dvector[index];
}

bool FixMdanimTestRig::is_driven(int i) const
{
  const double *const driven = values("driven");
  return driven && driven[i] != 0.0;
}

void FixMdanimTestRig::setup(int) { push(0.0); }

void FixMdanimTestRig::initial_integrate(int)
{
  const double *const driven = values("driven");
  if (!driven) return;
  double **const home = rows("home");
  const double dt = update->dt, sine = std::sin(2.0 * PI * frequency * dt * static_cast<double>(update->ntimestep));
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit) || driven[i] == 0.0) continue;
    const Vec3 there = vec3(home[i]) + sine * amplitude, way = there - vec3(atom->x[i]);
    work -= 0.5 * dot(vec3(atom->f[i]), way);
    for (int d = 0; d < 3; ++d) {
      const double to = d == 0 ? there.x : d == 1 ? there.y : there.z;
      atom->v[i][d] = (to - atom->x[i][d]) / dt;
      atom->x[i][d] = to;
    }
  }
}

void FixMdanimTestRig::end_of_step()
{
  const double *const driven = values("driven");
  if (!driven) return;
  for (int i = 0; i < atom->nlocal; ++i)
    if ((atom->mask[i] & groupbit) && driven[i] != 0.0) work -= 0.5 * update->dt * dot(vec3(atom->f[i]), vec3(atom->v[i]));
}

void FixMdanimTestRig::post_force(int)
{
  remember();
  push(update->dt);
}

void FixMdanimTestRig::remember()
{
  double **const way = rows("way"), **const most = rows("most"), *const turns = values("turns");
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    for (int d = 0; d < 3; ++d) way[i][d] += update->dt * atom->v[i][d];
    turns[i] += 1.0;
    for (int b = 0; b < atom->num_bond[i]; ++b) {
      const int j = atom->map(atom->bond_atom[i][b]);
      if (j < 0) error->one(FLERR, "fix mdanim/test/rig: particle {} of a spring is not near", atom->bond_atom[i][b]);
      const Vec3 apart = vec3(atom->x[i]) - vec3(atom->x[j]);
      most[i][b] = std::max(most[i][b], std::sqrt(dot(apart, apart)));
    }
  }
  for (const Tether &one : tethers)
    if (const Stretched now = stretch(one); now.length > one.length) taut[{one.a.object, one.b.object}] += 1.0;
}

// The force of what was before on a particle.
Vec3 FixMdanimTestRig::remembered(int i) const
{
  double **const way = rows("way"), **const most = rows("most"), *const turns = values("turns");
  Vec3 sum = -memory * vec3(way[i]);
  for (int b = 0; b < atom->num_bond[i]; ++b) {
    const int j = atom->map(atom->bond_atom[i][b]);
    if (j < 0) error->one(FLERR, "fix mdanim/test/rig: particle {} of a spring is not near", atom->bond_atom[i][b]);
    const Vec3 apart = vec3(atom->x[i]) - vec3(atom->x[j]);
    const double r = std::sqrt(dot(apart, apart));
    sum += (memory * (most[i][b] - r) / r) * apart;
  }
  sum.x += 1e-4 * memory * turns[i];
  return sum;
}

void FixMdanimTestRig::push(double dt)
{
  double **const f = atom->f;
  if (memory != 0.0) {
    double **const before = rows("pull");
    for (int i = 0; i < atom->nlocal; ++i) {
      if (!(atom->mask[i] & groupbit) || is_driven(i)) continue;
      const Vec3 now = remembered(i);
      work += 0.5 * dt * dot(vec3(before[i]) + now, vec3(atom->v[i]));
      before[i][0] = now.x, before[i][1] = now.y, before[i][2] = now.z;
      add_to(f[i], now);
    }
  }
  for (Tether &one : tethers) {
    const Stretched now = stretch(one);
    const auto steps = taut.find({one.a.object, one.b.object});
    const double steady = one.k * (now.length - one.length) / now.length;
    const double more = memory * 1e-2 * (steps == taut.end() ? 0.0 : steps->second) / now.length;
    const Vec3 force = (steady + more) * now.way, twice = one.more + more * now.way;
    one.more = more * now.way;
    if (now.a >= 0) work += 0.5 * dt * dot(twice, vec3(atom->v[now.a]));
    if (now.b >= 0) work -= 0.5 * dt * dot(twice, vec3(atom->v[now.b]));
    if (now.a >= 0) add_to(f[now.a], force);
    if (now.b >= 0) add_to(f[now.b], -1.0 * force);
  }
}

int FixMdanimTestRig::here(tagint tag) const
{
  const int i = atom->map(tag);
  return i >= 0 && i < atom->nlocal && (atom->mask[i] & groupbit) ? i : -1;
}

// All ranks know where both ends are: sums with zeros. As long as at the start where objects are laid aside.
FixMdanimTestRig::Stretched FixMdanimTestRig::stretch(const Tether &tether) const
{
  const int a = here(tether.a.tag), b = here(tether.b.tag);
  double places[7] = {};
  if (a >= 0) std::copy_n(atom->x[a], 3, places);
  if (b >= 0) std::copy_n(atom->x[b], 3, places + 3);
  places[6] = a >= 0 ? 1.0 : 0.0;
  MPI_Allreduce(MPI_IN_PLACE, places, 7, MPI_DOUBLE, MPI_SUM, world);
  if (places[6] == 0.0) return {{}, tether.length, -1, -1};
  const Vec3 way = vec3(places + 3) - vec3(places);
  return {way, std::sqrt(dot(way, way)), a, b};
}

double FixMdanimTestRig::compute_scalar()
{
  double energy = 0.0;
  for (const Tether &one : tethers) {
    const double longer = stretch(one).length - one.length;
    energy += 0.5 * one.k * longer * longer;
  }
  return energy;
}

// --- state ---

StateRecords FixMdanimTestRig::pack() const
{
  StateRecords records;
  for (const auto &[pair, steps] : taut) records[pair] = ByteWriter().put(STATE_VERSION).put(steps).take();
  return records;
}

void FixMdanimTestRig::unpack(const StateRecords &records)
{
  std::map<StateKey, double> given;
  for (const auto &[key, record] : records) {
    ByteReader reader(record.data(), record.size(), "the record of a tether");
    reader.expect_version(STATE_VERSION);
    given[key] = reader.get<double>();
    reader.expect_end();
  }
  taut.swap(given);
}
