// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/rigid: sums of forces over the particles of each object, the steps of rigid/body.h, and the particles put in place.

#include "lammps/fix_mdanim_rigid.h"

#include "lammps/keywords.h"
#include "lammps/particle_value.h"
#include "numbers/stopwatch.h"

#include "atom.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "memory.h"
#include "update.h"

#include <cmath>
#include <stdexcept>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static constexpr int COLUMNS = 13;    // of compute_array()

// fix ID group mdanim/rigid [inertia FILE]
FixMdanimRigid::FixMdanimRigid(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg)
{
  time_integrate = 1;
  rigid_flag = 1;
  dof_flag = 1;
  restart_global = 1;
  array_flag = 1;
  size_array_cols = COLUMNS;
  size_array_rows_variable = 1;
  extarray = 0;
  need(THREE_DIMENSIONS | ORTHOGONAL_BOX | OPEN_BOX | OBJECTS);
  const auto total = [this](double (RigidBody::*energy)() const) {
    double all = 0.0;
    for (const RigidBody &body : bodies) all += (body.*energy)();
    return force->mvv2e * all;
  };
  tell({{"bodies", true, [this] { return static_cast<double>(bodies.size()); }},
        {"translation", true, [total] { return total(&RigidBody::translation); }},
        {"rotation", true, [total] { return total(&RigidBody::rotation); }},
        clock()});

  for (int iarg = 3; iarg < narg; iarg += 2) {
    static const std::vector<Keyword> known = {{"inertia", "FILE"}};
    words_of_keyword(lmp, "fix mdanim/rigid", known, iarg, narg, arg);
    read_inertia_of(arg[iarg + 1]);
  }
  grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
}

FixMdanimRigid::~FixMdanimRigid()
{
  atom->delete_callback(id, Atom::GROW);
  memory->destroy(own);
}

int FixMdanimRigid::setmask() { return INITIAL_INTEGRATE | FINAL_INTEGRATE | PRE_NEIGHBOR; }

double FixMdanimRigid::mass_at(int i) const { return mass_of(atom->rmass, atom->mass, atom->type, i); }

void FixMdanimRigid::init()
{
  FixBase::init();
  reset_dt();
  find_objects();
  locate();
  try {
    if (restarted) unpack(StateRecords(*restarted));
  } catch (const std::exception &problem) {
    error->all(FLERR, "{}: {}", name(), problem.what());
  }
  if (bodies.empty())
    make();
  else
    follow_changes();
}

void FixMdanimRigid::reset_dt() { half_dt = 0.5 * update->dt * force->ftm2v; }

// Forces of fixes that are set up after this one are not there yet.
void FixMdanimRigid::setup(int) { collected = false; }

void FixMdanimRigid::setup_pre_neighbor() { locate(); }

void FixMdanimRigid::pre_neighbor() { locate(); }

// --- a step ---

void FixMdanimRigid::collect()
{
  const auto all = sums<6>([this](int i) {
    const Vec3 f = vec3(atom->f[i]), t = cross(vec3(atom->x[i]) - bodies[body_of[i]].centre, f);
    return std::array<double, 6>{f.x, f.y, f.z, t.x, t.y, t.z};
  });
  for (std::size_t n = 0; n < bodies.size(); ++n) {
    bodies[n].force = {all[n][0], all[n][1], all[n][2]};
    bodies[n].torque = {all[n][3], all[n][4], all[n][5]};
  }
  collected = true;
}

// Sets velocities of particles, and places as well if they have changed.
void FixMdanimRigid::put(bool places)
{
  for (int i = 0; i < atom->nlocal; ++i) {
    if (body_of[i] == ObjectTable::NONE) continue;
    const RigidBody &body = bodies[body_of[i]];
    const Vec3 from_centre = body.turn * vec3(own[i]), place = body.centre + from_centre, v = body.velocity_at(from_centre);
    if (places) atom->x[i][0] = place.x, atom->x[i][1] = place.y, atom->x[i][2] = place.z;
    atom->v[i][0] = v.x, atom->v[i][1] = v.y, atom->v[i][2] = v.z;
  }
}

void FixMdanimRigid::initial_integrate(int)
{
  const Lap lap(seconds);
  if (!collected) collect();
  for (RigidBody &body : bodies) {
    body.kick(half_dt);
    body.drift(update->dt);
  }
  put(true);
}

void FixMdanimRigid::final_integrate()
{
  const Lap lap(seconds);
  collect();
  for (RigidBody &body : bodies) body.kick(half_dt);
  put(false);
}

// --- output ---

// Kinetic energy of bodies less that of their particles, which LAMMPS's own sums hold: 0 unless a file gives other moments.
double FixMdanimRigid::compute_scalar()
{
  const auto of_particles = sums<1>([this](int i) {
    const Vec3 v = vec3(atom->v[i]);
    return std::array<double, 1>{0.5 * mass_at(i) * dot(v, v)};
  });
  double more = 0.0;
  for (std::size_t n = 0; n < bodies.size(); ++n) more += bodies[n].translation() + bodies[n].rotation() - of_particles[n][0];
  return force->mvv2e * more;
}

double FixMdanimRigid::compute_array(int row, int column)
{
  const RigidBody &body = bodies[row];
  const double numbers[COLUMNS] = {body.centre.x,   body.centre.y, body.centre.z, body.velocity.x, body.velocity.y,
                                   body.velocity.z, body.q.w,      body.q.x,      body.q.y,        body.q.z,
                                   body.spin.x,     body.spin.y,   body.spin.z};
  return numbers[column];
}

// Degrees of freedom that bodies take from the temperature of a group, if all their particles belong to it.
bigint FixMdanimRigid::dof(int number)
{
  std::vector<bigint> of_group(objects.size(), 0);
  for (int i = 0; i < atom->nlocal; ++i)
    if (body_of[i] != ObjectTable::NONE && (atom->mask[i] & group->bitmask[number])) ++of_group[body_of[i]];
  MPI_Allreduce(MPI_IN_PLACE, of_group.data(), objects.size(), MPI_LMP_BIGINT, MPI_SUM, world);
  bigint taken = 0;
  for (int n = 0; n < objects.size(); ++n)
    if (of_group[n] == particles[n]) taken += 3 * particles[n] - 6;
  return taken;
}

double FixMdanimRigid::memory_usage()
{
  return 3.0 * sizeof(double) * atom->nmax + bodies.size() * sizeof(RigidBody) + sizeof(int) * body_of.capacity() +
         objects.bytes();
}

// --- places in the body, which go with particles from rank to rank ---

void FixMdanimRigid::grow_arrays(int n) { memory->grow(own, n, 3, "fix mdanim/rigid"); }

void FixMdanimRigid::set_arrays(int i) { own[i][0] = own[i][1] = own[i][2] = 0.0; }

void FixMdanimRigid::copy_arrays(int from, int to, int)
{
  for (int k = 0; k < 3; ++k) own[to][k] = own[from][k];
}

int FixMdanimRigid::pack_exchange(int i, double *buffer)
{
  for (int k = 0; k < 3; ++k) buffer[k] = own[i][k];
  return 3;
}

int FixMdanimRigid::unpack_exchange(int i, double *buffer)
{
  for (int k = 0; k < 3; ++k) own[i][k] = buffer[k];
  return 3;
}
