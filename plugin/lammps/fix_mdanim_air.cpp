// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/air: from particles to points of surfaces, and from their forces to those on particles.

#include "lammps/fix_mdanim_air.h"

#include "lammps/fix_mdanim_tear.h"
#include "lammps/keywords.h"
#include "lammps/object_table.h"
#include "lammps/shared_file.h"
#include "numbers/stopwatch.h"
#include "records/byte_reader.h"

#include "atom.h"
#include "error.h"
#include "fmt/format.h"
#include "force.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static const char *const STYLE = "fix mdanim/air";
static constexpr int COLUMNS = 3;    // of compute_array()
static constexpr std::int64_t STATE_VERSION = 1;

// fix ID group mdanim/air DENSITY C [wind wx wy wz] [path T wx wy wz T wx wy wz ...] [above z] skins FILE
FixMdanimAir::FixMdanimAir(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg), above(-HUGE_VAL), nodes(lmp)
{
  array_flag = 1;
  restart_global = 1;
  size_array_cols = COLUMNS;
  extarray = 0;
  need(THREE_DIMENSIONS | OPEN_BOX | OBJECTS | ATOM_MAP);
  if (!atom->molecule_flag) error->all(FLERR, "{}: {}", STYLE, NO_OBJECTS);
  tell({{"work", true, [this] { return sum(work); }}, {"air_loss", true, [this] { return taken(); }}, clock()});

  need_words(lmp, STYLE, "fix ID group mdanim/air", "DENSITY C", narg - 3);
  density = positive(lmp, STYLE, "DENSITY", 3, arg);
  coefficient = positive(lmp, STYLE, "C", 4, arg);
  const auto number = [this, arg](int at) { return utils::numeric(FLERR, arg[at], false, this->lmp); };
  std::map<int, std::shared_ptr<const AirSkin>> skins;
  const std::vector<Keyword> known = {{"wind", "wx wy wz", "",
                                       [&](int at, char **) {
                                         path = VectorPath();
                                         path.append(0.0, {number(at + 1), number(at + 2), number(at + 3)});
                                       }},
                                      {"above", "z", "", [&](int at, char **) { above = number(at + 1); }},
                                      {"skins", "FILE", "", [&](int at, char **words) {
                                         try {
                                           skins = read_skins(words[at + 1],
                                                              read_shared_file(this->lmp, STYLE, "skins", words[at + 1]));
                                         } catch (const std::runtime_error &wrong) {
                                           error->all(FLERR, "{}: {}", STYLE, wrong.what());
                                         }
                                       }}};
  for (int iarg = 5; iarg < narg;) {
    if (strcmp(arg[iarg], "path") == 0)
      read_path(narg, arg, iarg);
    else
      iarg += take_keyword(lmp, STYLE, known, iarg, narg, arg);
  }
  if (path.empty()) path.append(0.0, {});
  if (skins.empty()) error->all(FLERR, "{}: there is no surface to push at; write skins FILE with a line object first", STYLE);
  for (auto &[molecule, skin] : skins) {
    nodes.append(molecule, skin->nodes());
    objects.push_back({std::move(skin), {}, {}});
  }
  size_array_rows = static_cast<int>(objects.size());
}

// Points of a path: a time and a velocity each.
void FixMdanimAir::read_path(int narg, char **arg, int &iarg)
{
  path = VectorPath();
  const auto is_number = [](const char *word) { return utils::is_double(word); };
  for (++iarg; iarg < narg && is_number(arg[iarg]); iarg += 4) {
    if (iarg + 4 > narg || !std::all_of(arg + iarg, arg + iarg + 4, is_number))
      error->all(FLERR, iarg, "{}: each point of a path is T wx wy wz", STYLE);
    double value[4];
    for (int k = 0; k < 4; ++k) value[k] = utils::numeric(FLERR, arg[iarg + k], false, lmp);
    if (!path.empty() && !(value[0] > path.last_time()))
      error->all(FLERR, iarg, "{}: times of a path ascend, got {} behind {}", STYLE, value[0], path.last_time());
    path.append(value[0], {value[1], value[2], value[3]});
  }
  if (path.empty()) error->all(FLERR, iarg - 1, "{}: a path has a point, T wx wy wz", STYLE);
}

int FixMdanimAir::setmask() { return PRE_NEIGHBOR | POST_INTEGRATE | POST_FORCE; }

void FixMdanimAir::init()
{
  FixBase::init();
  nodes.find(name());
  tears = FixMdanimTear::of(lmp);
  known_tears = 0;
  for (AirObject &one : objects) one.holes = {};
}

// --- forces ---

// Simulated time by the step alone, as all that changes with time has it.
Vec3 FixMdanimAir::wind() const { return path.at(static_cast<double>(update->ntimestep) * update->dt); }

// Takes away what links held together that are gone since the last time.
void FixMdanimAir::open_holes()
{
  if (!tears) return;
  for (; known_tears < tears->gone().size(); ++known_tears) {
    const GoneLink &link = tears->gone()[known_tears];
    for (int n = 0; n < nodes.count(); ++n)
      if (nodes.molecule(n) == link.object) objects[n].skin->open(link.low, link.high, objects[n].holes);
  }
}

// Velocities are those of half a step before: what has moved the particles here.
void FixMdanimAir::find_pushes()
{
  wind_now = wind();
  const AirLaw law{wind_now, 0.5 * density * coefficient, update->dt};
  const double units = 1.0 / force->ftm2v;
  open_holes();
  nodes.share();
  pushes.clear();
  for (int n = 0; n < nodes.count(); ++n) {
    AirObject &one = objects[n];
    one.force = {};
    if (!nodes.acts(n)) continue;
    const std::size_t first = nodes.first(n), count = nodes.end(n) - first;
    scratch.x.resize(count);
    scratch.v.resize(count);
    scratch.mass.resize(count);
    for (std::size_t k = 0; k < count; ++k) {
      scratch.x[k] = nodes.place(first + k);
      scratch.v[k] = nodes.speed(first + k);
      scratch.mass[k] = nodes.mass(first + k);
    }
    one.force = units * one.skin->push(law, above, one.holes, scratch);
    for (std::size_t k = 0; k < count; ++k)
      if (const int i = nodes.target(first + k); i != ObjectNodes::ELSEWHERE) pushes.push_back({i, units * scratch.force[k]});
  }
}

void FixMdanimAir::push() const
{
  for (const GivenForce &one : pushes) add_to(atom->f[one.i], one.force);
}

// A force acts over the half steps before and behind it, as leap-frog takes it: work F.w dt/2 of the wind, of which F.v dt/2 goes
// to the particle. What has been laid aside since then moves in another instance, which counts it.
void FixMdanimAir::count()
{
  const double half = 0.5 * update->dt;
  double of_wind = 0.0, given = 0.0;
  for (const GivenForce &one : pushes) {
    if (!(atom->mask[one.i] & groupbit)) continue;
    of_wind += dot(one.force, wind_now);
    given += dot(one.force, vec3(atom->v[one.i]));
  }
  work += half * of_wind;
  loss += half * (of_wind - given);
}

// Forces of a state act in place of those by its velocities.
void FixMdanimAir::setup(int)
{
  if (restarted) unpack(StateRecords(*restarted));
  find_pushes();
  for (GivenForce &one : pushes)
    if (const auto found = acted.find(atom->tag[one.i]); found != acted.end()) one.force = found->second;
  acted.clear();
  push();
}

void FixMdanimAir::post_integrate()
{
  const Lap lap(seconds);
  count();
}

void FixMdanimAir::post_force(int)
{
  const Lap lap(seconds);
  find_pushes();
  push();
  count();
}

// --- state ---

// Forces on the particles of an object.
StateRecords FixMdanimAir::pack() const
{
  if (restarted) return *restarted;
  StateRecords records;
  ParticleRows rows(lmp, STATE_VERSION, sizeof(Vec3));
  for (const GivenForce &one : pushes)
    if (atom->mask[one.i] & groupbit) rows.add(one.i, &one.force);
  rows.pack(records);
  return records;
}

void FixMdanimAir::unpack(const StateRecords &records)
{
  std::map<tagint, Vec3> found;
  ParticleRows(lmp, STATE_VERSION, sizeof(Vec3)).unpack(records, [&](int i, const std::uint8_t *from) {
    const auto force = ByteReader(from, sizeof(Vec3), "the force on a particle").get<Vec3>();
    if (!std::isfinite(dot(force, force))) throw std::runtime_error("a force of the air is damaged");
    found[atom->tag[i]] = force;
  });
  acted = std::move(found);
  restarted.reset();
}

void FixMdanimAir::write_restart(FILE *file) { mdanim::write_restart(*this, lmp, name(), file); }

void FixMdanimAir::restart(char *buffer)
{
  mdanim::read_restart([this](const StateRecords &all) { restarted = all; }, lmp, name(), buffer);
}

// --- output ---

double FixMdanimAir::compute_array(int n, int column)
{
  const Vec3 &force = objects[n].force;
  return column == 0 ? force.x : column == 1 ? force.y : force.z;
}

double FixMdanimAir::memory_usage()
{
  std::size_t skins = 0;
  std::vector<const AirSkin *> seen;
  for (const AirObject &one : objects) {
    if (std::find(seen.begin(), seen.end(), one.skin.get()) != seen.end()) continue;
    seen.push_back(one.skin.get());
    skins += one.skin->bytes();
  }
  return static_cast<double>(nodes.bytes() + skins);
}
