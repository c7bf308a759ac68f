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
  for (const auto &[molecule, one] : forces) turns = turns || one.turns();
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
  particles.locate();
  for (int n = 0; n < particles.objects().size(); ++n)
    if (windows(n).all.empty())
      error->all(FLERR, "{}: no force is given for object {} (molecule ID)", name(), particles.objects().id(n));
  mass = particles.sum_of([this](int i) { return particles.mass_at(i); });
}

// --- a step ---

bool FixMdanimForce::is_over() const
{
  double last = 0.0;
  for (const auto &[molecule, one] : forces) last = std::max(last, one.last());
  return (static_cast<double>(update->ntimestep) - 1.5) * update->dt > last;
}

bool FixMdanimForce::acts()
{
  now.resize(particles.objects().size());
  bool any = false;
  for (std::size_t n = 0; n < now.size(); ++n) {
    now[n] = windows(static_cast<int>(n)).at(update->ntimestep, update->dt);
    any = any || dot(now[n].force, now[n].force) > 0.0 || dot(now[n].torque, now[n].torque) > 0.0;
  }
  return any || acted;
}

// Accelerations of all objects in this step. Where nothing turns, places do not matter.
void FixMdanimForce::find_pushes()
{
  if (turns)
    bodies = particles.weigh();
  else
    bodies.assign(now.size(), {});
  pushes.assign(now.size(), {});
  acted = false;
  for (std::size_t n = 0; n < now.size(); ++n) {
    if (mass[n] == 0.0) continue;    // laid aside
    const bool pushed = dot(now[n].force, now[n].force) > 0.0, turned = dot(now[n].torque, now[n].torque) > 0.0;
    acted = acted || pushed || turned;
    pushes[n].centre = bodies[n].centre;
    pushes[n].a = (1.0 / mass[n]) * now[n].force;
    if (!turned || bodies[n].mass == 0.0) continue;
    if (!has_volume(bodies[n].inertia))
      error->all(FLERR, "{}: the particles of object {} (molecule ID) stand on a line, and nothing turns them about it", name(),
                 particles.objects().id(static_cast<int>(n)));
    pushes[n].alpha = inverse(matrix(bodies[n].inertia)) * now[n].torque;
  }
}

void FixMdanimForce::push_all() const
{
  for (int i = 0; i < atom->nlocal; ++i)
    if (const int n = particles.body_of(i); n != ObjectTable::NONE && particles.moves(i))
      add_to(atom->f[i], pushes[n].on(particles.mass_at(i), vec3(atom->x[i])));
}

void FixMdanimForce::setup(int)
{
  acted = false;
  const bool any = acts();
  find_pushes();
  if (any) push_all();
}

// Velocities are those of half a step before: what has moved the particles here. With them the force at the beginning of the step
// does f_i(t_n) v_i = m_i (a + alpha x (x_i(t_{n+1}) - dt v_i - c)) v_i, in which alpha x v_i does nothing.
void FixMdanimForce::count_work(const std::vector<WholePush> &before)
{
  double power = 0.0;
  if (turns) {
    const auto motion = particles.motion(bodies);
    for (std::size_t n = 0; n < pushes.size(); ++n)
      power += before[n].power(motion[n].momentum, motion[n].angular, bodies[n].centre) +
               pushes[n].power(motion[n].momentum, motion[n].angular, bodies[n].centre);
  } else {
    const auto momentum = particles.sums<3>([this](int i) {
      const Vec3 p = particles.mass_at(i) * vec3(atom->v[i]);
      return std::array<double, 3>{p.x, p.y, p.z};
    });
    for (std::size_t n = 0; n < pushes.size(); ++n)
      power += dot(before[n].a + pushes[n].a, {momentum[n][0], momentum[n][1], momentum[n][2]});
  }
  work += 0.5 * update->dt * power;
}

void FixMdanimForce::post_force(int)
{
  const Lap lap(seconds);
  if (!acts()) return;
  const std::vector<WholePush> before = pushes;
  find_pushes();
  count_work(before);
  push_all();
}

// --- together with run_style verlet/mdanim ---

void FixMdanimForce::append_required_atoms(std::vector<int> &wanted) const
{
  if (is_over()) return;
  for (int i = 0; i < atom->nlocal; ++i)
    if (particles.body_of(i) != ObjectTable::NONE) wanted.push_back(i);
}
