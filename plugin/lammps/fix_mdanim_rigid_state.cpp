// SPDX-License-Identifier: GPL-2.0-only
// The state of bodies and of their contacts as records.

#include "lammps/fix_mdanim_rigid.h"

#include "records/byte_reader.h"
#include "records/byte_writer.h"

#include "fmt/format.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

using namespace LAMMPS_NS;
using namespace mdanim;

static constexpr std::int64_t STATE_VERSION = 9;

namespace {

struct KeptBody {
  double mass;
  Vec3 moments, centre, velocity;
  Quaternion q;
  Vec3 L;
  Vec3 push, turning_push;    // of contact
  Pose pose;                  // of its shape
};

// A rotation has length 1; rounding leaves about 1e-15.
bool is_unit(const Quaternion &q) { return std::fabs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1.0) < 1e-9; }

template <class Kept> bool is_finite(const Kept &kept)    // of doubles alone
{
  const auto *numbers = reinterpret_cast<const double *>(&kept);
  return std::all_of(numbers, numbers + sizeof(Kept) / sizeof(double), [](double value) { return std::isfinite(value); });
}

// The body of an object, and the reader behind it.
KeptBody read_body(int object, const ParticleRows::RowsHead &head, bigint particles, std::optional<ByteReader> &rest)
{
  ByteReader reader(head.bytes.data(), head.bytes.size(), name_of_record({object, 0}));
  const auto kept = reader.get<KeptBody>();
  if (!is_finite(kept) || !(kept.mass > 0.0) || !(kept.moments.x > 0.0) || !is_unit(kept.q) || !is_unit(kept.pose.q))
    reader.is_damaged("its motion or its mass");
  if (static_cast<bigint>(head.rows) != particles)
    reader.fail(fmt::format("is of {} particles, the object has {}", head.rows, particles));
  rest = reader;
  return kept;
}

}    // namespace

// (a, 0): the body and its contacts with planes, then the places of particles in it. (a, b): contacts of two bodies.
StateRecords FixMdanimRigid::pack() const
{
  if (restarted) return *restarted;
  StateRecords records;
  if (bodies.empty()) return records;
  ParticleRows rows(lmp, STATE_VERSION, sizeof(Vec3));
  for (std::size_t n = 0; n < bodies.size(); ++n) {
    const RigidBody &body = bodies[n];
    const int number = static_cast<int>(n);
    KeptBody kept{body.mass, body.moments, body.centre, body.velocity, body.q, body.L, {}, {}, {}};
    ByteWriter head;
    const bool touches = touching.is_on();
    if (touches) kept.push = touching.push(number).force, kept.turning_push = touching.push(number).torque;
    if (touches) kept.pose = touching.pose(number);
    head.put(kept);
    sleep.put(n, head);
    glue.glued.put(number, head);
    if (touches && touching.solid(number) != RigidTouching::NO_SHAPE)
      touching.contact.put_at_planes(touching.solid(number), head);
    rows.begin(static_cast<int>(particles.objects().id(number)), head.take());
  }
  for (int i = 0; i < atom->nlocal; ++i) {
    const Vec3 own = particles.own(i);
    if (particles.moves(i)) rows.add(i, &own);
  }
  rows.pack(records);
  touching.put_driven(STATE_VERSION, records);
  touching.contact.each_pair_record([&](int a, int b, const Bytes &bytes) {
    records[{touching.contact.solid(a).id, touching.contact.solid(b).id}] =
        ByteWriter().put(STATE_VERSION).put(bytes.data(), bytes.size()).take();
  });
  return records;
}

void FixMdanimRigid::unpack(const StateRecords &all)
{
  StateRecords records;    // of bodies and pairs
  for (const auto &[key, bytes] : all)
    if (key.b != 0 || !touching.is_driven(key.a)) records[key] = bytes;
  if (particles.find_objects()) glue.forget_bodies();
  locate();
  const ObjectTable &objects = particles.objects();
  ParticleRows::Heads heads;
  std::vector<std::pair<int, Vec3>> places;    // of local particles
  const ParticleRows rows(lmp, STATE_VERSION, sizeof(Vec3));
  for (const auto &[key, bytes] : records)
    if (key.b == 0 && objects.number_of(key.a) == ObjectTable::NONE)
      ByteReader(bytes.data(), bytes.size(), name_of_record(key)).fail("is of an object that is not there");
  rows.unpack(
      records,
      [&](int i, const std::uint8_t *from) {
        if (particles.body_of(i) == ObjectTable::NONE) return;    // laid aside
        places.emplace_back(i, ByteReader(from, sizeof(Vec3), "the place of a particle").get<Vec3>());
        if (!is_finite(places.back().second)) throw std::runtime_error("a place in a body is damaged");
      },
      &heads);

  std::vector<KeptBody> kept(objects.size());
  std::vector<std::optional<ByteReader>> rest(objects.size());    // of each head, contacts with planes
  for (const auto &[object, head] : heads) {
    const int n = objects.number_of(object);
    if (bodies.empty() || !bodies[n].aside) kept[n] = read_body(object, head, particles.particles_of(n), rest[n]);
  }
  bool is_whole = !heads.empty();    // but for what is laid aside
  for (int n = 0; n < objects.size(); ++n) is_whole = is_whole && (rest[n] || (!bodies.empty() && bodies[n].aside));

  const std::vector<RigidBody> bodies_before = bodies;
  const RigidTouching touching_before = touching;
  const GluedBodies glued_before = glue.glued;
  try {
    if (!is_whole) make();    // those without a record as at the beginning
    bodies.resize(objects.size());
    std::vector<Pose> poses;
    for (int n = 0; n < objects.size(); ++n) {
      poses.push_back(rest[n] ? kept[n].pose : touching.pose(n));
      if (!rest[n]) continue;
      RigidBody &body = bodies[n];
      body.mass = kept[n].mass, body.moments = kept[n].moments, body.centre = kept[n].centre;
      body.velocity = kept[n].velocity, body.q = kept[n].q, body.L = kept[n].L;
      body.refresh();
    }
    touching.take(name(), objects, bodies, std::move(poses));
    sleep.read(rest);
    glue.unpack(name(), rest);
    sleep.tell_contact();
    touching.read_contacts(records, STATE_VERSION, rest);
    touching.read_driven(STATE_VERSION, all);
    for (int n = 0; n < objects.size(); ++n)
      if (rest[n]) touching.set_push(n, {kept[n].push, kept[n].turning_push});
  } catch (const std::runtime_error &) {
    bodies = bodies_before;
    touching = touching_before;
    glue.glued = glued_before;
    throw;
  }
  touching.is_current = is_whole;
  for (const auto &[i, place] : places) particles.set_own(i, place);
  restarted.reset();
  particles.put(bodies, true);
}

void FixMdanimRigid::write_restart(FILE *file) { mdanim::write_restart(*this, lmp, name(), file); }

void FixMdanimRigid::restart(char *buffer)
{
  mdanim::read_restart([this](const StateRecords &all) { restarted = all; }, lmp, name(), buffer);
}
