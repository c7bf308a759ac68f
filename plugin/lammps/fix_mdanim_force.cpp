// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/force: sums over the particles of each object, then one loop over them.

#include "lammps/fix_mdanim_force.h"

#include "forces/force_words.h"
#include "lammps/shared_file.h"
#include "numbers/stopwatch.h"

#include "atom.h"
#include "error.h"
#include "update.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <stdexcept>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static const char *const STYLE = "fix mdanim/force";

// fix ID group mdanim/force forces FILE
// fix ID group mdanim/force WORDS of forces/force_words.h
FixMdanimForce::FixMdanimForce(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg), particles(lmp, *this)
{
  need(THREE_DIMENSIONS | OPEN_BOX | OBJECTS);
  tell({{"work", true, [this] { return work; }}, clock()});
  try {
    read_command(narg, arg);
  } catch (const std::runtime_error &problem) {
    error->all(FLERR, "{}", problem.what());
  }
  for (const auto &[molecule, one] : forces) {
    turns = turns || one.turns();
    pushes_only = pushes_only || !one.turns();
  }
  if (!turns) return;
  maxexchange = 3;
  FixMdanimForce::grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
}

FixMdanimForce::~FixMdanimForce()
{
  if (turns) atom->delete_callback(id, Atom::GROW);
}

void FixMdanimForce::read_command(int narg, char **arg)
{
  if (narg == 5 && strcmp(arg[3], "forces") == 0) {
    of_objects = true;
    forces = read_forces(arg[4], read_shared_file(lmp, STYLE, "forces", arg[4]));
    return;
  }
  std::string words;
  for (int iarg = 3; iarg < narg; ++iarg) words += std::string(" ") + arg[iarg];
  forces[0] = read_force(words, STYLE);
}

int FixMdanimForce::setmask() { return POST_FORCE | PRE_NEIGHBOR; }

const ForceWindows &FixMdanimForce::windows(int object) const
{
  static const ForceWindows NONE;
  const auto found = forces.find(of_objects ? static_cast<int>(particles.objects().id(object)) : 0);
  return found == forces.end() ? NONE : found->second;
}

void FixMdanimForce::init()
{
  FixBase::init();
  particles.find_objects(true);
  of_object.clear();
  turned.clear();
  for (int n = 0; n < particles.objects().size(); ++n) {
    of_object.push_back(&windows(n));
    turned.push_back(of_object.back()->turns());
    if (of_object.back()->all.empty())
      error->all(FLERR, "{}: no force is given for object {} (molecule ID)", name(), particles.objects().id(n));
  }
  now.assign(of_object.size(), {});
  pushes.assign(of_object.size(), {});
  aside.assign(of_object.size(), 0);
  locate();
  mass = particles.sum_of([this](int i) { return particles.mass_at(i); });
  heaviest = particles.largest_of([this](int i) { return particles.mass_at(i); });
}

// Which particles are here, of which object each is, and which one of each has the lowest tag.
void FixMdanimForce::locate()
{
  particles.locate();
  forced.clear();
  for (int i = 0; i < atom->nlocal; ++i)
    if (particles.body_of(i) != ObjectTable::NONE) forced.push_back(i);
  here.resize(atom->nmax);
  std::vector<tagint> lowest(of_object.size(), MAXTAGINT);
  for (const int i : forced) lowest[particles.body_of(i)] = std::min(lowest[particles.body_of(i)], atom->tag[i]);
  MPI_Allreduce(MPI_IN_PLACE, lowest.data(), static_cast<int>(lowest.size()), MPI_LMP_TAGINT, MPI_MIN, world);
  first.assign(of_object.size(), -1);
  for (std::size_t n = 0; n < aside.size(); ++n) {
    aside[n] = lowest[n] == MAXTAGINT;
    if (aside[n]) pushes[n] = {};
  }
  for (const int i : forced)
    if (atom->tag[i] == lowest[particles.body_of(i)]) first[particles.body_of(i)] = i;
}

// --- a step ---

bool FixMdanimForce::is_over() const
{
  double last = 0.0;
  for (const auto &[molecule, one] : forces) last = std::max(last, one.last());
  return (static_cast<double>(update->ntimestep) - 1.5) * update->dt > last;
}

bool FixMdanimForce::turn_to_step()
{
  const auto acts = [](const ForceWindow &one) { return dot(one.force, one.force) > 0.0 || dot(one.torque, one.torque) > 0.0; };
  const bigint step = update->ntimestep;
  bool any = false;
  for (std::size_t n = 0; n < now.size(); ++n) {
    now[n] = of_object[n]->at(step, update->dt);
    any = any || acts(now[n]) || acts(of_object[n]->at(step - 1, update->dt)) || acts(of_object[n]->at(step + 1, update->dt));
  }
  return any;
}

// Sums are taken about a particle of each object, so that they have the same bits whatever has been before. Of objects without a
// torque the centre alone is found.
std::vector<FixMdanimForce::PushedObject> FixMdanimForce::whole_objects() const
{
  std::vector<PushedObject> found(now.size());
  for (std::size_t n = 0; n < found.size(); ++n)
    if (first[n] >= 0) found[n].about = here[first[n]];
  if (comm->nprocs > 1) {
    std::vector<double> all;
    for (const PushedObject &one : found) all.insert(all.end(), {one.about.x, one.about.y, one.about.z});
    MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_DOUBLE, MPI_SUM, world);
    for (std::size_t n = 0; n < found.size(); ++n) found[n].about = {all[3 * n], all[3 * n + 1], all[3 * n + 2]};
  }
  if (pushes_only) find_centres(found);
  if (turns) find_motions(found);
  return found;
}

void FixMdanimForce::find_centres(std::vector<PushedObject> &objects) const
{
  const auto sums = particles.sums<3>(
      [&](int i) {
        const Vec3 mr = particles.mass_at(i) * (here[i] - objects[particles.body_of(i)].about);
        return std::array<double, 3>{mr.x, mr.y, mr.z};
      },
      [this](int n) { return !turned[n]; });
  for (std::size_t n = 0; n < objects.size(); ++n)
    if (mass[n] > 0.0) objects[n].centre = objects[n].about + (1.0 / mass[n]) * Vec3{sums[n][0], sums[n][1], sums[n][2]};
}

// Bounds of all terms follow from the largest distance, the largest way and the largest mass.
void FixMdanimForce::find_motions(std::vector<PushedObject> &objects) const
{
  const auto asked = [this](int n) { return turned[n] != 0; };
  const auto far = particles.largest<2>(
      [&](int i) {
        const Vec3 r = here[i] - objects[particles.body_of(i)].about, way = here[i] - before[i];
        return std::array<double, 2>{dot(r, r), dot(way, way)};
      },
      asked);
  std::vector<std::array<double, 12>> bounds(objects.size());
  for (std::size_t n = 0; n < objects.size(); ++n) {
    const double m = heaviest[n], r = 1.001 * std::sqrt(far[n][0]), l = 1.001 * m * r * std::sqrt(far[n][1]);
    for (int k = 0; k < 12; ++k) bounds[n][k] = k < 3 ? m * r : k < 9 ? m * r * r : l;
  }
  const auto sums = particles.sums_within<12>(
      [&](int i) {
        const double m = particles.mass_at(i);
        const Vec3 r = here[i] - objects[particles.body_of(i)].about, mr = m * r, l = cross(mr, here[i] - before[i]);
        const double xx = mr.x * r.x, yy = mr.y * r.y, zz = mr.z * r.z;
        return std::array<double, 12>{mr.x,        mr.y,        mr.z,        yy + zz, xx + zz, xx + yy,
                                      -mr.x * r.y, -mr.x * r.z, -mr.y * r.z, l.x,     l.y,     l.z};
      },
      asked, bounds);
  for (std::size_t n = 0; n < objects.size(); ++n) {
    if (!turned[n] || mass[n] == 0.0) continue;
    const auto &of = sums[n];
    const double m = mass[n];
    const Vec3 d = (1.0 / m) * Vec3{of[0], of[1], of[2]};
    PushedObject &one = objects[n];
    one.centre = one.about + d;
    one.inertia = {of[3] - m * (d.y * d.y + d.z * d.z),
                   of[4] - m * (d.x * d.x + d.z * d.z),
                   of[5] - m * (d.x * d.x + d.y * d.y),
                   of[6] + m * d.x * d.y,
                   of[7] + m * d.x * d.z,
                   of[8] + m * d.y * d.z};
    one.swept = {of[9], of[10], of[11]};
  }
}

void FixMdanimForce::find_pushes(bool counts)
{
  const std::vector<PushedObject> objects = whole_objects();
  double done = 0.0;
  for (std::size_t n = 0; n < pushes.size(); ++n) {
    if (aside[n]) continue;
    const PushedObject &object = objects[n];
    WholePush push;
    push.centre = object.centre;
    push.a = (1.0 / mass[n]) * now[n].force;
    if (dot(now[n].torque, now[n].torque) > 0.0) {
      if (!has_volume(object.inertia))
        error->all(FLERR, "{}: the particles of object {} (molecule ID) stand on a line, and nothing turns them about it", name(),
                   particles.objects().id(static_cast<int>(n)));
      push.alpha = inverse(matrix(object.inertia)) * now[n].torque;
    }
    const Vec3 way = mass[n] * (object.centre - pushes[n].centre);
    done += pushes[n].work(way, object.swept, object.about) + push.work(way, object.swept, object.about);
    pushes[n] = push;
  }
  if (counts) work += 0.5 * done;
  if (turns) std::swap(here, before);
}

void FixMdanimForce::setup(int)
{
  for (const int i : forced) here[i] = vec3(atom->x[i]);
  if (turns) before = here;
  turn_to_step();
  find_pushes(false);
  for (const int i : forced) add_to(atom->f[i], pushes[particles.body_of(i)].on(particles.mass_at(i), vec3(atom->x[i])));
}

void FixMdanimForce::post_force(int)
{
  const Lap lap(seconds);
  if (!turn_to_step()) return;
  for (const int i : forced) here[i] = vec3(atom->x[i]);
  find_pushes(true);
  for (const int i : forced) add_to(atom->f[i], pushes[particles.body_of(i)].on(particles.mass_at(i), vec3(atom->x[i])));
}

double FixMdanimForce::memory_usage()
{
  return particles.bytes() +
         static_cast<double>(sizeof(int) * forced.capacity() + sizeof(Vec3) * (here.capacity() + before.capacity()));
}

// --- places of the last step ---

int FixMdanimForce::pack_exchange(int i, double *into)
{
  std::memcpy(into, &before[i], sizeof(Vec3));
  return maxexchange;
}

int FixMdanimForce::unpack_exchange(int i, double *from)
{
  std::memcpy(static_cast<void *>(&before[i]), from, sizeof(Vec3));
  return maxexchange;
}

// --- together with run_style verlet/mdanim ---

void FixMdanimForce::append_required_atoms(std::vector<int> &wanted) const
{
  if (!is_over()) wanted.insert(wanted.end(), forced.begin(), forced.end());
}

void FixMdanimForce::add_forces(const Positions &place, const ForceSums &force)
{
  const Lap lap(seconds);
  if (is_over() || !turn_to_step()) return;
  for (std::size_t n = 0; n < forced.size(); ++n) here[forced[n]] = place[n];
  find_pushes(true);
  for (std::size_t n = 0; n < forced.size(); ++n)
    force.add(n, pushes[particles.body_of(forced[n])].on(particles.mass_at(forced[n]), place[n]));
}
