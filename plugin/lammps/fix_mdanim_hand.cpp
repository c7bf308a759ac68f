// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/hand: from particles to material points, and from hands to forces on particles.

#include "lammps/fix_mdanim_hand.h"

#include "hands/hand_words.h"
#include "lammps/shared_file.h"
#include "numbers/stopwatch.h"
#include "records/byte_reader.h"
#include "records/byte_writer.h"

#include "atom.h"
#include "error.h"
#include "fmt/format.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mpi.h>
#include <stdexcept>
#include <utility>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static const char *const STYLE = "fix mdanim/hand";
static constexpr std::int64_t STATE_VERSION = 1;

// fix ID group mdanim/hand [hands FILE]
FixMdanimHand::FixMdanimHand(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg), shared(lmp)
{
  restart_global = 1;
  need(THREE_DIMENSIONS | OPEN_BOX | ATOM_MAP);
  tell({{"work", true, [this] { return work; }}, clock()});
  if (narg == 3) return;
  if (narg != 5 || strcmp(arg[3], "hands") != 0)
    error->all(FLERR, "{}: it is written as 'fix ID group mdanim/hand' or '... hands FILE'", STYLE);
  try {
    for (Hand &one : read_hands(arg[4], read_shared_file(lmp, STYLE, "hands", arg[4]))) held.push_back({std::move(one), {}, {}});
  } catch (const std::runtime_error &problem) {
    error->all(FLERR, "{}", problem.what());
  }
}

int FixMdanimHand::setmask() { return POST_FORCE | PRE_NEIGHBOR; }

// fix_modify ID hold WORDS, fix_modify ID key t x y z
int FixMdanimHand::modify_param(int narg, char **arg)
{
  std::string text;
  for (int n = 1; n < narg; ++n) text += std::string(arg[n]) + " ";
  try {
    if (strcmp(arg[0], "hold") == 0) {
      const bool over =
          std::all_of(held.begin(), held.end(), [&](const Held &one) { return one.hand.is_over(update->ntimestep, update->dt); });
      if (over) held.clear();
      held.push_back({read_hand(text, name()), {}, {}});
      choose();
      locate();
      go_on(held.back());
      return narg;
    }
    if (strcmp(arg[0], "key") == 0) {
      if (held.empty()) throw std::runtime_error(name() + ": there is no hand that the key is of; write hold first");
      held.back().hand.keys.push_back(read_key(text, name(), held.back().hand));
      return narg;
    }
  } catch (const std::runtime_error &problem) {
    error->all(FLERR, "{}", problem.what());
  }
  return 0;
}

void FixMdanimHand::init()
{
  FixBase::init();
  choose();
}

// --- particles ---

void FixMdanimHand::choose()
{
  std::vector<tagint> tags;
  for (const Held &one : held) tags.insert(tags.end(), one.hand.tags.begin(), one.hand.tags.end());
  std::sort(tags.begin(), tags.end());
  tags.erase(std::unique(tags.begin(), tags.end()), tags.end());
  shared.choose(std::move(tags));
  for (Held &one : held) {
    one.numbers.clear();
    for (const std::int64_t tag : one.hand.tags) one.numbers.push_back(shared.number_of(static_cast<tagint>(tag)));
  }
}

// A hand does nothing when its object has left the group: it has been laid aside.
void FixMdanimHand::locate()
{
  shared.locate(name(), groupbit);
  for (Held &one : held)
    one.acts = std::any_of(one.numbers.begin(), one.numbers.end(), [this](int number) { return shared.is_pushed(number); });
}

// --- a step ---

// Whether no hand has a part in this step; the same on all ranks.
bool FixMdanimHand::is_idle() const
{
  return std::all_of(held.begin(), held.end(), [this](const Held &one) {
    return dot(one.force, one.force) == 0.0 && !one.hand.at(update->ntimestep, update->dt);
  });
}

// Place and velocity of the point that it holds.
HandMotion FixMdanimHand::point_of(const Held &one) const
{
  HandMotion point;
  for (std::size_t n = 0; n < one.numbers.size(); ++n) {
    const int row = shared.row_of(one.numbers[n]);
    point.at += one.hand.weights[n] * shared.place(row);
    point.velocity += one.hand.weights[n] * shared.speed(row);
  }
  return point;
}

// A hand that had taken hold before a run was stopped: its force is among those on the particles already, and has a part in the
// work of the next step.
void FixMdanimHand::go_on(Held &one)
{
  const auto now = one.hand.at(update->ntimestep, update->dt);
  if (!now || !one.acts) return;
  shared.share();
  one.force = force_at(one, *now, point_of(one));
}

Vec3 FixMdanimHand::force_at(const Held &one, const HandMotion &now, const HandMotion &point)
{
  if (!acted.empty()) {
    const std::pair key(object_of(one), one.hand.keys.front().time);
    if (const auto found = acted.lower_bound(key); found != acted.end() && found->first == key)
      return acted.extract(found).mapped();
  }
  return one.hand.force(now, point.at, point.velocity);
}

double FixMdanimHand::pull()
{
  shared.share();
  double power = 0.0;
  for (Held &one : held) {
    const Vec3 before = std::exchange(one.force, {});
    const auto now = one.hand.at(update->ntimestep, update->dt);
    if (!one.acts || (!now && dot(before, before) == 0.0)) continue;
    const HandMotion point = point_of(one);
    if (now) one.force = force_at(one, *now, point);
    power += dot(before + one.force, point.velocity);
    for (std::size_t n = 0; n < one.numbers.size(); ++n)
      if (const int i = shared.local(one.numbers[n]); i != SharedMotion::ELSEWHERE && shared.is_pushed(one.numbers[n]))
        add_to(atom->f[i], one.hand.weights[n] * one.force);
  }
  return power;
}

void FixMdanimHand::setup(int)
{
  if (restarted) unpack(StateRecords(*restarted));
  for (Held &one : held) one.force = {};
  if (!is_idle()) pull();
}

// Velocities are those of half a step before: what has moved the particles here.
void FixMdanimHand::post_force(int)
{
  const Lap lap(seconds);
  acted.clear();
  if (!is_idle()) work += 0.5 * update->dt * pull();
}

// --- together with run_style verlet/mdanim ---

void FixMdanimHand::append_required_atoms(std::vector<int> &wanted) const
{
  for (const Held &one : held) {
    if (one.hand.is_over(update->ntimestep, update->dt)) continue;
    for (const int number : one.numbers)
      if (const int i = shared.local(number); i != SharedMotion::ELSEWHERE) wanted.push_back(i);
  }
}

// --- state ---

// The same on all ranks; 0 where particles are of no object.
int FixMdanimHand::object_of(const Held &one) const
{
  int here = 0, all = 0;
  const int i = shared.local(one.numbers.front());
  if (atom->molecule_flag && i != SharedMotion::ELSEWHERE) here = static_cast<int>(atom->molecule[i]);
  MPI_Allreduce(&here, &all, 1, MPI_INT, MPI_MAX, world);
  return all;
}

// A record for each object that is pulled at: the first key of each hand and its force.
StateRecords FixMdanimHand::pack() const
{
  if (restarted) return *restarted;
  StateRecords records;
  for (const Held &one : held) {
    if (!one.acts || dot(one.force, one.force) == 0.0) continue;
    Bytes &record = records[{object_of(one), 0}];
    ByteWriter writer(std::move(record));
    if (writer.is_empty()) writer.put(STATE_VERSION);
    record = writer.put(one.hand.keys.front().time).put(one.force).take();
  }
  return records;
}

void FixMdanimHand::unpack(const StateRecords &records)
{
  std::multimap<std::pair<int, double>, Vec3> found;
  for (const auto &[key, record] : records) {
    ByteReader reader(record.data(), record.size(), fmt::format("the record of the hands on object {}", key.a));
    reader.expect_version(STATE_VERSION);
    while (reader.left() > 0) {
      const auto begin = reader.get<double>();
      const auto force = reader.get<Vec3>();
      if (!std::isfinite(begin) || !std::isfinite(dot(force, force))) reader.is_damaged("a force");
      found.insert({{key.a, begin}, force});
    }
  }
  acted = std::move(found);
  restarted.reset();
}

void FixMdanimHand::write_restart(FILE *file) { mdanim::write_restart(*this, lmp, name(), file); }

void FixMdanimHand::restart(char *buffer)
{
  mdanim::read_restart([this](const StateRecords &all) { restarted = all; }, lmp, name(), buffer);
}
