// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/drive: one loop over the particles at both ends of a step.

#include "lammps/fix_mdanim_drive.h"

#include "drives/motion_words.h"
#include "lammps/object_table.h"
#include "lammps/shared_file.h"
#include "numbers/stopwatch.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fmt/format.h"
#include "force.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static const char *const STYLE = "fix mdanim/drive";
static constexpr int KEPT = 3;    // numbers in restart files

// --- the command ---

// fix ID group mdanim/drive [home d2_NAME|none] [since STEP] [release FIXID] [leave GROUP] motions FILE
// fix ID group mdanim/drive [home d2_NAME|none] [since STEP] [release FIXID] [leave GROUP] WORDS of drives/motion_words.h
FixMdanimDrive::FixMdanimDrive(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg), since(update->ntimestep)
{
  time_integrate = 1;
  restart_global = 1;
  nevery = 1;
  need(THREE_DIMENSIONS | OPEN_BOX);
  look_up({&left}, {});
  tell({{"work", true, [this] { return sum(work); }}, clock()});
  try {
    read_command(narg, arg);
  } catch (const std::runtime_error &problem) {
    error->all(FLERR, "{}", problem.what());
  }
  if (of_objects) need(OBJECTS);
  for (const auto &[molecule, motion] : motions) releases = releases || std::isfinite(motion.until);
}

FixMdanimDrive::~FixMdanimDrive()
{
  if (!own_home.empty() && modify->get_fix_by_id(own_home)) modify->delete_fix(own_home);
}

void FixMdanimDrive::read_command(int narg, char **arg)
{
  int iarg = 3;
  const auto is = [&](const char *word) { return iarg + 1 < narg && strcmp(arg[iarg], word) == 0; };
  for (bool more = true; more;) {
    more = false;
    if (is("home")) {
      tells_alone = strcmp(arg[iarg + 1], "none") == 0;
      if (!tells_alone && strncmp(arg[iarg + 1], "d2_", 3) != 0)
        error->all(FLERR, iarg + 1, "{}: home is none, or a property of three numbers, d2_NAME, got {}", STYLE, arg[iarg + 1]);
      if (!tells_alone) home_name = arg[iarg + 1] + 3;
      more = true;
    } else if (is("since")) {
      since = utils::bnumeric(FLERR, arg[iarg + 1], false, lmp);
      more = true;
    } else if (is("release")) {
      integrator = arg[iarg + 1];
      more = true;
    } else if (is("leave")) {
      left = NamedGroup(lmp, STYLE, iarg + 1, arg[iarg + 1]);
      more = true;
    }
    if (more) iarg += 2;
  }
  if (is("motions")) {
    if (narg > iarg + 2) error->all(FLERR, iarg + 2, "{}: motions FILE ends the command, got also {}", STYLE, arg[iarg + 2]);
    of_objects = true;
    motions = read_motions(arg[iarg + 1], read_shared_file(lmp, STYLE, "motions", arg[iarg + 1]));
    return;
  }
  std::string words;
  for (; iarg < narg; ++iarg) words += std::string(" ") + arg[iarg];
  motions[0] = read_motion(words, STYLE);
}

// Places at the start as a property of particles, so that they migrate with them and are in restart files.
void FixMdanimDrive::post_constructor()
{
  if (tells_alone || !home_name.empty()) return;
  home_name = fmt::format("{}_home", id);
  own_home = fmt::format("{}_HOME", id);
  Fix *const keeper = modify->add_fix(fmt::format("{} all property/atom d2_{} 3", own_home, home_name));
  if (keeper->restart_reset) return;
  double **const at = home();
  for (int i = 0; i < atom->nlocal; ++i)
    for (int d = 0; d < 3; ++d) at[i][d] = atom->x[i][d];
}

double **FixMdanimDrive::home() const
{
  int is_double = 0, columns = 0;
  const int index = atom->find_custom(home_name.c_str(), is_double, columns);
  if (index < 0 || !is_double || columns != 3)
    error->all(FLERR, "{}: there is no property d2_{} of three numbers; write 'fix ... property/atom d2_{} 3'", name(), home_name,
               home_name);
  return atom->darray[index];
}

int FixMdanimDrive::setmask() { return INITIAL_INTEGRATE | FINAL_INTEGRATE | END_OF_STEP; }

void FixMdanimDrive::init()
{
  FixBase::init();
  if (!tells_alone) home();
  if (dt_before != 0.0 && dt_before != update->dt)
    error->all(FLERR, "{}: the time step has changed from {} to {}, and places would jump; define the fix anew", name(),
               dt_before, update->dt);
  dt_before = update->dt;
  found_at.reset();
  if (!releases) return;
  const Fix *const mover = integrator.empty() ? nullptr : modify->get_fix_by_id(integrator);
  if (!integrator.empty() && !mover)
    error->all(FLERR, "{}: release {} is not the ID of a fix; write that of the fix that moves what is released", name(),
               integrator);
  joined = mover ? mover->groupbit : 0;
  release(update->ntimestep + 1);
}

// --- motion ---

// Simulated time by the step alone.
double FixMdanimDrive::time(bigint step) const { return static_cast<double>(step - since) * update->dt; }

void FixMdanimDrive::find_ways()
{
  if (found_at == update->ntimestep) return;
  const bool follows = found_at && *found_at + 1 == update->ntimestep;
  for (const auto &[molecule, motion] : motions) {
    Ways &one = ways_now[molecule];
    one.before = follows ? one.now : motion.at(time(update->ntimestep - 1));
    one.now = follows ? one.next : motion.at(time(update->ntimestep));
    one.next = motion.at(time(update->ntimestep + 1));
  }
  found_at = update->ntimestep;
  last_molecule = -1;
}

const FixMdanimDrive::Ways *FixMdanimDrive::ways_of(int molecule)
{
  find_ways();
  const auto found = ways_now.find(of_objects ? molecule : 0);
  return found == ways_now.end() ? nullptr : &found->second;
}

// The way of a local particle; those of an object follow each other in most cases.
const FixMdanimDrive::Ways &FixMdanimDrive::ways(int i)
{
  const int molecule = of_objects ? static_cast<int>(atom->molecule[i]) : 0;
  if (molecule != last_molecule) {
    last_ways = ways_of(molecule);
    if (!last_ways) error->one(FLERR, "{}: no motion is given for object {} (molecule ID)", name(), molecule);
    last_molecule = molecule;
  }
  return *last_ways;
}

bool FixMdanimDrive::holds(int molecule) const
{
  const auto found = motions.find(of_objects ? molecule : 0);
  return found != motions.end() && static_cast<double>(update->ntimestep - since) <= found->second.last_step(update->dt);
}

bool FixMdanimDrive::shifts() const { return !of_objects && !motions.at(0).turns(); }

DrivenPlace FixMdanimDrive::place_before(double ago) const { return motions.at(0).at(time(update->ntimestep) - ago); }

// A particle of the group that is not laid aside.
bool FixMdanimDrive::guides(int i)
{
  if (!(atom->mask[i] & groupbit)) return false;
  return !releases || holds(of_objects ? static_cast<int>(atom->molecule[i]) : 0);
}

// Whether something is released in this step.
bool FixMdanimDrive::is_due() const
{
  return releases && std::any_of(motions.begin(), motions.end(), [this](const auto &one) {
           return static_cast<double>(update->ntimestep - since) == one.second.last_step(update->dt) + 1.0;
         });
}

// From its release on, a particle is in the group of those that an integrator moves, unless a fix of rigid bodies does so;
// before, it is not. At that step it brings its energy of motion.
void FixMdanimDrive::release(bigint step)
{
  int rigid = 0;
  for (const Fix *const fix : modify->get_fix_list())
    if (fix->rigid_flag) rigid |= fix->groupbit;
  for (int i = 0; i < atom->nlocal; ++i) {
    int &mask = atom->mask[i];
    if (!(mask & groupbit)) continue;
    const auto motion = motions.find(of_objects ? static_cast<int>(atom->molecule[i]) : 0);
    if (motion == motions.end() || !std::isfinite(motion->second.until)) continue;
    const double behind = static_cast<double>(step - since) - motion->second.last_step(update->dt);
    const bool is_free = behind > 0.0;
    mask = is_free ? mask & ~left.bit() : mask | left.bit();
    if (mask & rigid) continue;
    const bool joins = is_free && joined && !(mask & joined);
    mask = is_free ? mask | joined : mask & ~joined;
    if (joins && behind == 1.0) {
      const Vec3 v = vec3(atom->v[i]);
      work += 0.5 * force->mvv2e * mass_of(atom->rmass, atom->mass, atom->type, i) * dot(v, v);
    }
  }
}

std::set<int> FixMdanimDrive::present() const
{
  std::vector<int> ids, here;
  for (const auto &[molecule, motion] : motions) ids.push_back(molecule);
  here.assign(ids.size(), 0);
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    const int molecule = of_objects ? static_cast<int>(atom->molecule[i]) : 0;
    const auto found = std::lower_bound(ids.begin(), ids.end(), molecule);
    if (found != ids.end() && *found == molecule) here[found - ids.begin()] = 1;
  }
  MPI_Allreduce(MPI_IN_PLACE, here.data(), static_cast<int>(here.size()), MPI_INT, MPI_MAX, world);
  std::set<int> found;
  for (std::size_t n = 0; n < ids.size(); ++n)
    if (here[n]) found.insert(ids[n]);
  return found;
}

void FixMdanimDrive::setup(int) { set_whole_velocities(); }

void FixMdanimDrive::final_integrate()
{
  const Lap lap(seconds);
  set_whole_velocities();
}

// Velocities of whole steps: the mean of the step that ends here and the next one.
void FixMdanimDrive::set_whole_velocities()
{
  if (tells_alone) return;
  double **const start = home();
  const double per_two = 0.5 / update->dt;
  find_ways();
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!guides(i)) continue;
    const Ways &way = ways(i);
    const Vec3 velocity = per_two * (way.next.of(vec3(start[i])) - way.before.of(vec3(start[i])));
    atom->v[i][0] = velocity.x, atom->v[i][1] = velocity.y, atom->v[i][2] = velocity.z;
  }
}

void FixMdanimDrive::initial_integrate(int)
{
  if (tells_alone) return;
  const Lap lap(seconds);
  double **const start = home();
  const double per_dt = 1.0 / update->dt;
  find_ways();
  if (is_due()) release(update->ntimestep);
  double done = 0.0;    // of one step: small beside all work, so that its sum keeps its digits
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!guides(i)) continue;
    const Vec3 there = ways(i).now.of(vec3(start[i])), way = there - vec3(atom->x[i]), velocity = per_dt * way;
    done += dot(vec3(atom->f[i]), way);
    atom->v[i][0] = velocity.x, atom->v[i][1] = velocity.y, atom->v[i][2] = velocity.z;
    atom->x[i][0] = there.x, atom->x[i][1] = there.y, atom->x[i][2] = there.z;
  }
  work -= 0.5 * done;
}

void FixMdanimDrive::end_of_step()
{
  if (tells_alone) return;
  const Lap lap(seconds);
  double **const start = home();
  double done = 0.0;
  for (int i = 0; i < atom->nlocal; ++i)
    if (guides(i)) done += dot(vec3(atom->f[i]), vec3(atom->x[i]) - ways(i).before.of(vec3(start[i])));
  work -= 0.5 * done;
}

// --- restart ---

void FixMdanimDrive::write_restart(FILE *file)
{
  const double all = sum(work), list[KEPT] = {static_cast<double>(since), all, dt_before};
  if (comm->me != 0) return;
  const int size = sizeof list;
  fwrite(&size, sizeof(int), 1, file);
  fwrite(list, sizeof list, 1, file);
}

void FixMdanimDrive::restart(char *buffer)
{
  double list[KEPT];
  std::memcpy(list, buffer, sizeof list);
  since = static_cast<bigint>(list[0]);
  work = comm->me == 0 ? list[1] : 0.0;
  dt_before = list[2];
}
