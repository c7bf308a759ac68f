// SPDX-License-Identifier: GPL-2.0-only
// The state of joints as records.

#include "lammps/fix_mdanim_joint.h"

#include "records/byte_reader.h"
#include "records/byte_writer.h"

#include "atom.h"
#include "fmt/format.h"
#include "force.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

using namespace LAMMPS_NS;
using namespace mdanim;

static constexpr std::int64_t STATE_VERSION = 2;

tagint FixMdanimJoint::lowest_of(int object) const
{
  if (object == WORLD) return 0;
  const auto found = lowest_tags.find(object);
  if (found == lowest_tags.end()) throw std::runtime_error(problem);
  return found->second;
}

static StateKey key_of(const JointWords &words)
{
  const int a = words.a.object, b = words.b.object;
  return b == WORLD ? StateKey{a, 0} : StateKey{std::min(a, b), std::max(a, b)};
}

namespace {

void put_end(ByteWriter &writer, const JointEnd &end, tagint lowest)
{
  std::vector<std::int32_t> tags;    // counted from the lowest of the object
  for (const std::int64_t tag : end.tags) tags.push_back(static_cast<std::int32_t>(tag - lowest));
  writer.put_counted(tags).put_all(end.patch.members()).put(end.patch.centre()).put(end.d);
}

JointEnd get_end(ByteReader &reader, tagint lowest)
{
  JointEnd end;
  for (const std::int32_t tag : reader.get_counted<std::int32_t>()) end.tags.push_back(lowest + tag);
  auto members = reader.get_all<Patch::Member>(end.tags.size());
  const auto centre = reader.get<Vec3>();
  end.d = reader.get<Vec3>();
  for (const Patch::Member &one : members)
    if (!(one.mass > 0.0)) reader.is_damaged("the mass of a particle");
  if (!members.empty()) end.patch = Patch::from(std::move(members), centre);
  return end;
}

std::string name_of(const StateKey &key)
{
  return key.b ? fmt::format("the record of the joints of {} and {}", key.a, key.b)
               : fmt::format("the record of the joints of {} and the world", key.a);
}

}    // namespace

// A record for each pair of objects, or an object and the world, with all its joints in the order of the fix.
StateRecords FixMdanimJoint::pack() const
{
  if (restarted) return *restarted;
  StateRecords records;
  for (std::size_t n = 0; n < joints.size(); ++n) {
    if (!acts[n]) continue;
    const JointWords &own = words[n];
    Bytes &record = records[key_of(own)];
    ByteWriter writer(std::move(record));
    if (writer.is_empty()) writer.put(STATE_VERSION);
    writer.put(static_cast<std::int64_t>(own.kind)).put(joints[n].past()).put(joints[n].rest_length());
    writer.put_counted(joints[n].spends() ? std::vector<Joint::Spending>{joints[n].spending()} : std::vector<Joint::Spending>());
    put_end(writer, joints[n].a(), lowest_of(own.a.object));
    put_end(writer, joints[n].b(), lowest_of(own.b.object));
    record = writer.take();
  }
  return records;
}

void FixMdanimJoint::unpack(const StateRecords &records)
{
  std::map<StateKey, ByteReader> readers;
  for (const auto &[key, record] : records) {
    readers.emplace(key, ByteReader(record.data(), record.size(), name_of(key)));
    readers.at(key).expect_version(STATE_VERSION);
  }
  std::vector<Joint> taken;
  for (std::size_t n = 0; n < words.size(); ++n) {
    const auto found = readers.find(key_of(words[n]));
    if (found == readers.end()) {
      if (joints.empty()) throw std::runtime_error(problem);
      taken.push_back(joints[n]);
      taken.back().forget();
      continue;
    }
    ByteReader &reader = found->second;
    if (reader.get<std::int64_t>() != static_cast<std::int64_t>(words[n].kind))
      reader.fail("is of joints of other kinds, or in another order");
    const auto past = reader.get<Joint::Past>();
    const auto length = reader.get<double>();
    const auto spending = reader.get_counted<Joint::Spending>();
    JointEnd a = get_end(reader, lowest_of(words[n].a.object)), b = get_end(reader, lowest_of(words[n].b.object));
    a.moves = pushes[2 * n], b.moves = pushes[2 * n + 1];
    if (!std::isfinite(past.q) || !(length >= 0.0)) reader.is_damaged("its angle or its length");
    taken.emplace_back(words[n], std::move(a), std::move(b), length, force->ftm2v);
    taken.back().set_past(past, spending.empty() ? Joint::Spending() : spending.front());
  }
  for (const auto &[key, reader] : readers) reader.expect_end();
  expect_particles(taken);
  joints = std::move(taken);
  problem.clear();
  number_particles();
  restarted.reset();
  is_taken_up = true;
}

// LAMMPS's own map may be out of date.
void FixMdanimJoint::expect_particles(const std::vector<Joint> &of) const
{
  const std::vector<tagint> tags = tags_of(of);
  bigint here = 0, all = 0;
  for (int i = 0; i < atom->nlocal; ++i) here += std::binary_search(tags.begin(), tags.end(), atom->tag[i]);
  MPI_Allreduce(&here, &all, 1, MPI_LMP_BIGINT, MPI_SUM, world);
  if (all != static_cast<bigint>(tags.size()))
    throw std::runtime_error(fmt::format("of {} particles in the state {} are there", tags.size(), all));
}

void FixMdanimJoint::write_restart(FILE *file) { mdanim::write_restart(*this, lmp, name(), file); }

void FixMdanimJoint::restart(char *buffer)
{
  mdanim::read_restart([this](const StateRecords &all) { restarted = all; }, lmp, name(), buffer);
}
