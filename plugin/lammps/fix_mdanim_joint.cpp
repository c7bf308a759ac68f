// SPDX-License-Identifier: GPL-2.0-only
// fix mdanim/joint: from particles to the motion of patches, and from loads on patches to forces on particles.

#include "lammps/fix_mdanim_joint.h"

#include "lammps/object_table.h"
#include "lammps/shared_file.h"
#include "numbers/stopwatch.h"

#include "atom.h"
#include "error.h"
#include "fmt/format.h"
#include "update.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

using namespace LAMMPS_NS;
using namespace FixConst;
using namespace mdanim;

static constexpr int COLUMNS = 13;    // of compute_array()

// fix ID group mdanim/joint [joints FILE] [joint KIND A B words ...] ...
FixMdanimJoint::FixMdanimJoint(LAMMPS *lmp, int narg, char **arg) : FixBase(lmp, narg, arg), shared(lmp)
{
  restart_global = 1;
  need(THREE_DIMENSIONS | ORTHOGONAL_BOX | OPEN_BOX | OBJECTS | ATOM_MAP);
  if (!atom->molecule_flag) error->all(FLERR, "fix mdanim/joint: {}", NO_OBJECTS);
  const auto energy = [this] {
    double all = 0.0;
    for (std::size_t n = 0; n < joints.size(); ++n)
      if (acts[n]) all += joints[n].reading().energy;
    return all;
  };
  const auto broken = [this] {
    double all = 0.0;
    for (std::size_t n = 0; n < joints.size(); ++n) all += acts[n] && joints[n].is_broken();
    return all;
  };
  tell({{"joints", true, energy},
        {"joint_heat", true, [this] { return account.heat; }},
        {"work", true, [this] { return account.work; }},
        {"broken", true, broken},
        clock()});

  read_words(narg, arg);
  FoundJoints found = find_joints(lmp, groupbit, words);
  joints = std::move(found.joints);
  lowest_tags = std::move(found.lowest_tags);
  problem = std::move(found.problem);
  pushes = std::move(found.pushes);
  acts.assign(words.size(), 1);
  array_flag = 1;
  size_array_cols = COLUMNS;
  size_array_rows = static_cast<int>(words.size());
  extarray = 0;
  number_particles();
}

void FixMdanimJoint::read_words(int narg, char **arg)
{
  const auto begins = [&](int i) { return strcmp(arg[i], "joint") == 0 || strcmp(arg[i], "joints") == 0; };
  if (narg < 4)
    error->all(FLERR, Error::ARGZERO,
               "fix mdanim/joint: it is written as 'fix ID group mdanim/joint joint KIND A B words' or 'joints FILE'");
  for (int i = 3; i < narg;) {
    const int first = i++;
    if (!begins(first)) error->all(FLERR, first, "fix mdanim/joint: unknown keyword {}; it knows joint and joints", arg[first]);
    try {
      if (strcmp(arg[first], "joints") == 0) {
        if (i == narg) error->all(FLERR, first, "fix mdanim/joint: missing arguments, it is written as 'joints FILE'");
        const char *const file = arg[i++];
        for (JointWords &one : read_joints(file, read_shared_file(lmp, "fix mdanim/joint", "joints", file)))
          words.push_back(std::move(one));
        continue;
      }
      std::string text;
      for (; i < narg && !begins(i); ++i) text += std::string(arg[i]) + " ";
      LineWords line(text, "joint " + std::to_string(words.size() + 1));
      words.push_back(read_joint(line));
    } catch (const std::exception &wrong) {
      error->all(FLERR, first, "fix mdanim/joint: {}", wrong.what());
    }
  }
}

int FixMdanimJoint::setmask() { return PRE_NEIGHBOR | POST_FORCE; }

void FixMdanimJoint::init()
{
  FixBase::init();
  try {
    if (restarted) {
      unpack(StateRecords(*restarted));
      is_taken_up = false;    // forces are found anew
    }
  } catch (const std::exception &wrong) {
    error->all(FLERR, "{}: {}", name(), wrong.what());
  }
  if (!problem.empty()) error->all(FLERR, "{}: {}", name(), problem);
}

// --- particles ---

std::vector<tagint> FixMdanimJoint::tags_of(const std::vector<Joint> &of)
{
  std::vector<tagint> tags;
  for (const Joint &joint : of)
    for (const JointEnd *end : {&joint.a(), &joint.b()}) tags.insert(tags.end(), end->tags.begin(), end->tags.end());
  std::sort(tags.begin(), tags.end());
  tags.erase(std::unique(tags.begin(), tags.end()), tags.end());
  return tags;
}

void FixMdanimJoint::number_particles()
{
  shared.choose(tags_of(joints));
  number.clear();
  for (const Joint &joint : joints)
    for (const JointEnd *end : {&joint.a(), &joint.b()})
      for (const std::int64_t tag : end->tags) number.push_back(shared.number_of(static_cast<tagint>(tag)));
}

// A joint does nothing when an end has left the group: its object has been laid aside.
void FixMdanimJoint::locate()
{
  shared.locate(name(), groupbit);
  row.resize(number.size());
  target.resize(number.size());
  std::size_t member = 0;
  for (std::size_t end = 0; end < 2 * joints.size(); ++end) {
    const Joint &joint = joints[end / 2];
    bool pushed = false;
    for (std::size_t n = (end % 2 == 0 ? joint.a() : joint.b()).tags.size(); n > 0; --n, ++member) {
      const int which = number[member];
      row[member] = shared.row_of(which);
      target[member] = shared.is_pushed(which) ? shared.local(which) : SharedMotion::ELSEWHERE;
      pushed = pushed || shared.is_pushed(which);
    }
    if (end % 2 == 0) acts[end / 2] = 1;
    if (pushes[end] && !pushed) acts[end / 2] = 0;
  }
}

template <class Step> void FixMdanimJoint::each_joint(const Step &step)
{
  shared.share();
  double **const f = atom->f;
  std::size_t first = 0;
  for (std::size_t n = 0; n < joints.size(); ++n) {
    Joint &joint = joints[n];
    const std::size_t second = first + joint.a().tags.size(), next = second + joint.b().tags.size();
    if (acts[n]) {
      const auto motion = [&](const JointEnd &end, std::size_t from) {
        return end.patch.motion([&](std::size_t m) { return shared.place(row[from + m]); },
                                [&](std::size_t m) { return shared.speed(row[from + m]); });
      };
      const auto give = [&](const JointEnd &end, std::size_t from, const PatchLoad &load) {
        end.patch.give(load, [&](std::size_t m, const Vec3 &force) {
          if (const int i = target[from + m]; i != SharedMotion::ELSEWHERE) add_to(f[i], force);
        });
      };
      const Joint::Loads loads = step(joint, motion(joint.a(), first), motion(joint.b(), second));
      give(joint.a(), first, loads.a);
      give(joint.b(), second, loads.b);
    }
    first = next;
  }
}

void FixMdanimJoint::setup(int)
{
  each_joint(
      [&](Joint &joint, const PatchMotion &a, const PatchMotion &b) { return joint.begin(a, b, update->dt, !is_taken_up); });
  is_taken_up = false;
}

// Velocities are those of half a step before: what has moved the particles here.
void FixMdanimJoint::post_force(int)
{
  const Lap lap(seconds);
  each_joint([&](Joint &joint, const PatchMotion &a, const PatchMotion &b) { return joint.step(a, b, update->dt, account); });
}

// --- output ---

double FixMdanimJoint::compute_scalar() { return compute_vector(0) + account.heat - account.work; }

double FixMdanimJoint::compute_array(int n, int column)
{
  if (joints.empty()) return 0.0;    // they could not be made
  const Joint &joint = joints[n];
  const Joint::Reading &now = joint.reading();
  const double numbers[COLUMNS] = {
      now.force,  now.torque, joint.way(), now.rate,   now.driving, now.gap,   joint.is_broken() ? 1.0 : 0.0,
      now.at_a.x, now.at_a.y, now.at_a.z,  now.at_b.x, now.at_b.y,  now.at_b.z};
  return numbers[column];
}

double FixMdanimJoint::memory_usage()
{
  const std::size_t lists = (number.capacity() + row.capacity() + target.capacity()) * sizeof(int);
  const std::size_t members = number.size() * (sizeof(Patch::Member) + sizeof(std::int64_t));
  return static_cast<double>(shared.bytes() + lists + members + joints.size() * sizeof(Joint));
}
