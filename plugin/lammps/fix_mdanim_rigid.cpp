// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/rigid: sums of forces over the particles of each object, the steps of rigid/body.h, and the particles put in place.

#include "lammps/fix_mdanim_rigid.h"

#include "lammps/keywords.h"
#include "lammps/shared_file.h"
#include "numbers/stopwatch.h"
#include "rigid/moments_file.h"

#include "atom.h"
#include "error.h"
#include "force.h"
#include "update.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static constexpr int COLUMNS = 24;    // of compute_array()

static std::map<int, Inertia> moments_of(LAMMPS *lmp, const char *file)
{
  const std::string text = read_shared_file(lmp, "fix mdanim/rigid", "moments of inertia", file);
  try {
    return read_moments(file, text);
  } catch (const std::exception &problem) {
    lmp->error->all(FLERR, "fix mdanim/rigid: {}", problem.what());
  }
  return {};
}

// fix ID group mdanim/rigid [inertia FILE] [lambda L] [glue FILE] [shapes FILE contact OMEGA EPS], and words of RigidTouching
FixMdanimRigid::FixMdanimRigid(LAMMPS *lmp, int narg, char **arg)
    : FixBase(lmp, narg, arg), particles(lmp, *this), touching(lmp), guided(particles, touching, bodies),
      glue(lmp, particles, touching, bodies), sleep(lmp, touching, glue, bodies), forces(lmp, particles, bodies)
{
  time_integrate = 1;
  rigid_flag = 1;
  dof_flag = 1;
  restart_global = 1;
  create_attribute = 1;
  array_flag = 1;
  size_array_cols = COLUMNS;
  size_array_rows_variable = 1;
  extarray = 0;
  need(THREE_DIMENSIONS | ORTHOGONAL_BOX | OPEN_BOX | OBJECTS);
  look_up({}, {&lambda});
  tell_numbers();

  std::vector<Keyword> known = {{"inertia", "FILE"}, {"lambda", "L|d_NAME"}, {"glue", "FILE"}, RigidSleep::word()};
  for (Keyword &word : RigidTouching::words()) known.push_back(std::move(word));
  for (int iarg = 3, words = 0; iarg < narg; iarg += words) {
    words = words_of_keyword(lmp, "fix mdanim/rigid", known, iarg, narg, arg);
    if (strcmp(arg[iarg], "inertia") == 0) {
      given = moments_of(lmp, arg[iarg + 1]);
    } else if (strcmp(arg[iarg], "lambda") == 0) {
      lambda = ParticleValue(lmp, "fix mdanim/rigid: lambda", iarg + 1, arg[iarg + 1]);
      has_drag = true;
    } else if (strcmp(arg[iarg], "glue") == 0) {
      glue.read_file(arg[iarg + 1]);
    } else if (strcmp(arg[iarg], "sleep") == 0) {
      sleep.read_word(iarg, arg);
    } else {
      touching.read_word(iarg, arg);
    }
  }
  touching.check();
  grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
}

FixMdanimRigid::~FixMdanimRigid() { atom->delete_callback(id, Atom::GROW); }

void FixMdanimRigid::tell_numbers()
{
  const auto total = [this](const auto &energy_of) {
    const std::vector<bigint> present = particles.present();    // what was laid aside has no part
    double all = 0.0;
    for (std::size_t n = 0; n < bodies.size(); ++n)
      if (present[n] > 0) all += energy_of(n);
    return force->mvv2e * all;
  };
  std::vector<mdanim::Output> outputs = {
      {"bodies", true, [this] { return static_cast<double>(bodies.size()); }},
      {"translation", true, [this, total] { return total([this](std::size_t n) { return bodies[n].translation(); }); }},
      {"rotation", true, [this, total] { return total([this](std::size_t n) { return bodies[n].rotation(); }); }},
      clock(),
      {"drag_loss", true, [this] { return force->mvv2e * drag_loss; }}};
  for (mdanim::Output &output : touching.outputs()) outputs.push_back(std::move(output));
  const auto collects = [this] { return collected || (collect(), true); };
  for (mdanim::Output &output : glue.outputs(collects, half_dt, drag)) outputs.push_back(std::move(output));
  for (mdanim::Output &output : sleep.outputs()) outputs.push_back(std::move(output));
  tell(std::move(outputs));
}

int FixMdanimRigid::setmask() { return INITIAL_INTEGRATE | FINAL_INTEGRATE | PRE_NEIGHBOR; }

void FixMdanimRigid::init()
{
  FixBase::init();
  reset_dt();
  touching.init(name());
  if (particles.find_objects(largest(has_new_particles) > 0.0)) glue.forget_bodies();
  has_new_particles = false;
  for (const auto &[molecule, inertia] : given)
    if (particles.objects().number_of(molecule) == ObjectTable::NONE)
      error->all(FLERR, "{}: there are moments of inertia for object {} (molecule ID), which has no particle in its group",
                 name(), molecule);
  size_array_rows = particles.objects().size();
  locate();
  try {
    if (restarted) unpack(StateRecords(*restarted));
  } catch (const std::exception &problem) {
    error->all(FLERR, "{}: {}", name(), problem.what());
  }
  bodies.empty() ? make() : follow_changes();
}

void FixMdanimRigid::reset_dt() { half_dt = 0.5 * update->dt * force->ftm2v; }

// Forces of fixes that are set up after this one are not there yet. Those of contact have been found already in a run that goes
// on from another.
void FixMdanimRigid::setup(int)
{
  collected = false;
  touching.contact.begin_account();
  if (touching.guide()) {
    guided.find(half_dt, drag);
    guided.set_whole_motion(update->dt);
    particles.put(bodies, false);
  }
  if (!touching.is_current) touching.step(bodies, 0.0);
}

void FixMdanimRigid::setup_pre_neighbor() { locate(); }

void FixMdanimRigid::pre_neighbor() { locate(); }

// Objects without particles in the group have been laid aside.
void FixMdanimRigid::locate()
{
  particles.locate();
  forces.forget();
  const std::vector<bigint> present = particles.present();
  for (std::size_t n = 0; n < bodies.size(); ++n) {
    bodies[n].aside = present[n] == 0;
    touching.lay_aside(static_cast<int>(n), bodies[n].aside);
  }
  touching.lay_driven_aside();
}

// --- a step ---

void FixMdanimRigid::collect()
{
  const RigidForces::Sums &all = forces.find();
  const double units = 1.0 / force->ftm2v;    // contact has forces in units of mass times acceleration
  for (std::size_t n = 0; n < bodies.size(); ++n) {
    bodies[n].force = {all[n][0], all[n][1], all[n][2]};
    bodies[n].torque = {all[n][3], all[n][4], all[n][5]};
    if (!touching.is_on()) continue;
    const RigidTouching::Push push = touching.push(static_cast<int>(n));
    bodies[n].force += units * push.force;
    bodies[n].torque += units * push.torque;
  }
  drag.assign(bodies.size(), 0.0);
  if (has_drag) {
    const double *const own = lambda.values(lmp);
    drag = particles.sum_of([&](int i) { return own ? own[i] : lambda.number; });
  }
  glue.gather(drag);
  collected = true;
}

void FixMdanimRigid::initial_integrate(int)
{
  const Lap lap(seconds);
  if (!collected) collect();
  guided.find(half_dt, drag);
  glue.kick(half_dt, drag, true, drag_loss);
  glue.drift(update->dt);
  guided.move(update->dt);
  particles.put(bodies, true, false);
}

void FixMdanimRigid::final_integrate()
{
  const Lap lap(seconds);
  guided.touch(update->dt);
  collect();
  sleep.wake_some();
  glue.kick(half_dt, drag, false, drag_loss);
  guided.set_whole_motion(update->dt);
  glue.break_some(half_dt, drag, [this] { collect(); });
  sleep.put_some_to_sleep(half_dt, drag);
  particles.put(bodies, false, false);
}

// --- output ---

// Kinetic energy of bodies less that of their particles, which LAMMPS's own sums hold: 0 unless a file gives other moments. With
// it the energy of contacts, and what contacts and drag have taken.
double FixMdanimRigid::compute_scalar()
{
  const std::vector<double> of_particles = particles.kinetic();
  double more = glue.torn_energy() + sleep.taken();
  for (std::size_t n = 0; n < bodies.size(); ++n) more += bodies[n].translation() + bodies[n].rotation() - of_particles[n];
  const TouchAccount &account = touching.contact.found();
  return force->mvv2e * (more + account.energy + account.heat + account.damped + account.let_go + drag_loss - touching.taken());
}

double FixMdanimRigid::compute_array(int row, int column)
{
  const auto &[f, t, at] = glue.load_of(row, [this] { return collected || (collect(), true); });
  const Vec3 &c = bodies[row].centre, &v = bodies[row].velocity, &w = bodies[row].spin;
  const Quaternion &q = bodies[row].q;
  const double whole = glue.molecule_of_whole(row), bore = glue.glued.stress(row);
  return std::array<double, COLUMNS>{c.x, c.y,   c.z, v.x, v.y, v.z, q.w, q.x, q.y,  q.z,  w.x,  w.y,
                                     w.z, whole, f.x, f.y, f.z, t.x, t.y, t.z, at.x, at.y, at.z, bore}[column];
}

double FixMdanimRigid::memory_usage()
{ return particles.bytes() + static_cast<double>(bodies.size() * sizeof(RigidBody) + touching.contact.bytes()); }
