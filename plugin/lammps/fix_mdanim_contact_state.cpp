// SPDX-License-Identifier: GPL-2.0-only
// The memory of contacts, as records of pairs of objects, (a, b), and of objects at planes, (a, 0).

#include "lammps/fix_mdanim_contact.h"

#include "records/byte_reader.h"
#include "records/byte_writer.h"

#include "fmt/format.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <string>

using namespace LAMMPS_NS;
using namespace mdanim;

static constexpr std::int64_t STATE_VERSION = 1;

namespace {

// Whether all of a row from this byte on are finite numbers.
template <class Row> bool has_numbers(const Row &row, std::size_t from)
{
  double values[sizeof(Row) / sizeof(double)];
  const std::size_t bytes = sizeof(Row) - from;
  std::memcpy(values, reinterpret_cast<const std::uint8_t *>(&row) + from, bytes);
  return std::all_of(values, values + bytes / sizeof(double), [](double value) { return std::isfinite(value); });
}

}    // namespace

StateRecords FixMdanimContact::pack() const
{
  if (restarted) return *restarted;
  StateRecords records;
  for (const auto &[ids, contacts] : world_of_contact.pair_contacts()) {
    records[{ids.first, ids.second}] =
        ByteWriter().put(STATE_VERSION).put_counted(contacts.first).put_counted(contacts.second).take();
  }
  for (const auto &[object_id, contacts] : world_of_contact.plane_contacts()) {
    records[{object_id, 0}] = ByteWriter().put(STATE_VERSION).put_counted(contacts).take();
  }
  return records;
}

void FixMdanimContact::unpack(const StateRecords &records)
{
  take_objects(Contacts::ARE_REPLACED);
  std::map<int, const ContactBody *> body_of;
  for (int n = 0; n < world_of_contact.objects(); ++n)
    body_of[world_of_contact.object(n).id] = world_of_contact.object(n).body.get();
  const auto is_point = [&](int object_id, int point) {
    return point >= 0 && point < static_cast<int>(body_of.at(object_id)->points().size());
  };
  ContactWorld::PairContacts pairs;
  ContactWorld::PlaneContacts planes;
  for (const auto &[key, bytes] : records) {
    const std::string what = key.b ? fmt::format("objects {} and {}", key.a, key.b) : fmt::format("object {}", key.a);
    ByteReader reader(bytes.data(), bytes.size(), "the record of " + what);
    const auto bad = [&](const char *why) { reader.fail(why); };
    if (!body_of.count(key.a) || (key.b && !body_of.count(key.b))) bad("is of an object that is not there");
    reader.expect_version(STATE_VERSION);
    if (key.b) {
      auto &[lower, higher] = pairs[{key.a, key.b}];
      lower = reader.get_counted<FieldContact>();
      higher = reader.get_counted<FieldContact>();
      const auto check = [&](const std::vector<FieldContact> &rows, int owner, int host) {
        int before = -1;
        for (const FieldContact &row : rows) {
          if (!is_point(owner, row.point) || row.side < 0 || row.side >= body_of[host]->sides() ||
              !body_of[host]->is_filled(row.cell[0], row.cell[1], row.cell[2]))
            bad("has points that there are not");
          if (row.point <= before) bad("has points that do not ascend");
          if (!has_numbers(row, offsetof(FieldContact, state))) bad("has a value that is not a number");
          before = row.point;
        }
      };
      check(lower, key.a, key.b);
      check(higher, key.b, key.a);
    } else {
      planes[key.a] = reader.get_counted<PlaneContact>();
      std::pair<int, int> before{-1, -1};
      for (const PlaneContact &row : planes[key.a]) {
        if (!is_point(key.a, row.point) || row.plane < 0 ||
            row.plane >= static_cast<int>(world_of_contact.settings.planes.size()))
          bad("has points or planes that there are not");
        if (std::pair{row.plane, row.point} <= before) bad("has points that do not ascend");
        if (!has_numbers(row, offsetof(PlaneContact, anchor))) bad("has a value that is not a number");
        before = {row.plane, row.point};
      }
    }
    reader.expect_end();
  }
  world_of_contact.restore(pairs, planes);
  restarted.reset();
}

void FixMdanimContact::write_restart(FILE *file) { mdanim::write_restart(*this, lmp, name(), file); }

void FixMdanimContact::restart(char *buffer)
{
  mdanim::read_restart([this](const StateRecords &all) { restarted = all; }, lmp, name(), buffer);
}
