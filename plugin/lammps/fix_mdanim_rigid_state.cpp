// SPDX-License-Identifier: GPL-2.0-only
// The state of bodies, as records of objects, (a, 0).

#include "lammps/fix_mdanim_rigid.h"

#include "lammps/rank_gather.h"
#include "records/byte_reader.h"
#include "records/byte_writer.h"

#include "fmt/format.h"

#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <unordered_map>

using namespace LAMMPS_NS;
using namespace mdanim;

static constexpr std::int64_t STATE_VERSION = 1;

namespace {

struct KeptBody {
  double mass;
  Vec3 moments, centre, velocity;
  Quaternion q;
  Vec3 L;
};

struct KeptPlace {
  std::int64_t tag;    // counted from the lowest of the object
  Vec3 own;
};

struct PlaceRow {
  std::int64_t object, tag;
  Vec3 own;
  bool operator<(const PlaceRow &other) const { return std::tie(object, tag) < std::tie(other.object, other.tag); }
};

template <class Kept> bool is_finite(const Kept &kept)    // of doubles alone
{
  const auto *numbers = reinterpret_cast<const double *>(&kept);
  return std::all_of(numbers, numbers + sizeof(Kept) / sizeof(double), [](double value) { return std::isfinite(value); });
}

}    // namespace

StateRecords FixMdanimRigid::pack() const
{
  if (restarted) return *restarted;
  std::vector<PlaceRow> here;
  for (int i = 0; i < atom->nlocal && !bodies.empty(); ++i)
    if (moves(i)) here.push_back({atom->molecule[i], atom->tag[i], vec3(own[i])});
  std::vector<PlaceRow> rows = gather(world, here);
  std::sort(rows.begin(), rows.end());
  StateRecords records;
  for (auto first = rows.begin(); first != rows.end();) {
    const auto last = std::find_if(first, rows.end(), [&](const PlaceRow &row) { return row.object != first->object; });
    std::vector<KeptPlace> places;
    for (auto row = first; row != last; ++row) places.push_back({row->tag - first->tag, row->own});
    const RigidBody &body = bodies[objects.number_of(static_cast<tagint>(first->object))];
    const KeptBody kept{body.mass, body.moments, body.centre, body.velocity, body.q, body.L};
    records[{static_cast<int>(first->object), 0}] = ByteWriter().put(STATE_VERSION).put(kept).put_counted(places).take();
    first = last;
  }
  return records;
}

void FixMdanimRigid::unpack(const StateRecords &records)
{
  find_objects();
  locate();
  std::vector<tagint> lowest(objects.size(), MAXTAGINT);
  std::unordered_map<tagint, int> local;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!moves(i)) continue;
    lowest[body_of[i]] = std::min(lowest[body_of[i]], atom->tag[i]);
    local.emplace(atom->tag[i], i);
  }
  MPI_Allreduce(MPI_IN_PLACE, lowest.data(), objects.size(), MPI_LMP_TAGINT, MPI_MIN, world);

  std::vector<std::pair<int, KeptBody>> kept_bodies;
  std::vector<std::pair<int, Vec3>> kept_places;      // of local particles
  std::vector<bigint> found_of(objects.size(), 0);    // particles of each object that have a place
  for (const auto &[key, bytes] : records) {
    const int n = key.b ? ObjectTable::NONE : objects.number_of(key.a);
    ByteReader reader(bytes.data(), bytes.size(), fmt::format("the record of object {}", key.a));
    if (n == ObjectTable::NONE) reader.fail("is of an object that is not there");
    reader.expect_version(STATE_VERSION);
    kept_bodies.emplace_back(n, reader.get<KeptBody>());
    const auto places = reader.get_counted<KeptPlace>();
    reader.expect_end();
    const KeptBody &body = kept_bodies.back().second;
    if (!is_finite(body) || !(body.mass > 0.0) || !(body.moments.x > 0.0)) reader.is_damaged("its motion or its mass");
    if (static_cast<bigint>(places.size()) != particles[n])
      reader.fail(fmt::format("is of {} particles, the object has {}", places.size(), particles[n]));
    for (const KeptPlace &place : places) {
      if (!is_finite(place.own)) reader.is_damaged("a place in the body");
      const auto found = local.find(static_cast<tagint>(lowest[n] + place.tag));
      if (found == local.end() || body_of[found->second] != n) continue;
      kept_places.emplace_back(found->second, place.own);
      ++found_of[n];
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, found_of.data(), objects.size(), MPI_LMP_BIGINT, MPI_SUM, world);
  for (const auto &[n, kept] : kept_bodies)
    if (found_of[n] != particles[n])
      throw std::runtime_error(fmt::format("the record of object {} is of other particles: {} of {} are there", objects.id(n),
                                           found_of[n], particles[n]));

  restarted.reset();
  if (static_cast<int>(kept_bodies.size()) < objects.size()) make();    // those without a record are as at the beginning
  bodies.resize(objects.size());
  for (const auto &[n, kept] : kept_bodies) {
    RigidBody &body = bodies[n];
    body.mass = kept.mass, body.moments = kept.moments, body.centre = kept.centre, body.velocity = kept.velocity;
    body.q = kept.q, body.L = kept.L;
    body.refresh();
  }
  for (const auto &[i, place] : kept_places) own[i][0] = place.x, own[i][1] = place.y, own[i][2] = place.z;
  put(true);
}

void FixMdanimRigid::write_restart(FILE *file) { mdanim::write_restart(*this, lmp, name(), file); }

void FixMdanimRigid::restart(char *buffer)
{
  mdanim::read_restart([this](const StateRecords &all) { restarted = all; }, lmp, name(), buffer);
}
