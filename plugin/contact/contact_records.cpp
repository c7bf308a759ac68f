// SPDX-License-Identifier: GPL-2.0-only
// The memory of contacts as bytes.

#include "contact/contact_world.h"
#include "contact/object_field.h"
#include "contact/plane_field.h"
#include "records/byte_reader.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

namespace mdanim {

static constexpr std::int64_t STATE_VERSION = 1;

// Both fields of a pair, each with the number of its contacts, or those of an object at all planes with one number; behind these
// the forces on planes that move.
StateRecords ContactWorld::records() const
{
  StateRecords found;
  for (auto one = fields.begin(), end = one; one != fields.end(); one = end) {
    const StateKey key = one->first.record();
    std::int64_t touching = 0;
    for (; end != fields.end() && !(key < end->first.record()) && !(end->first.record() < key); ++end)
      touching += static_cast<std::int64_t>(end->second->touching());
    if (touching == 0) continue;    // a plane that nothing touches bears no force
    ByteWriter writer;
    writer.put(STATE_VERSION);
    if (key.b == 0) writer.put(touching);
    for (auto field = one; field != end; ++field) {
      if (key.b != 0) writer.put(static_cast<std::int64_t>(field->second->touching()));
      field->second->put_rows(writer);
    }
    for (int p = 0; key.b == 0 && p < static_cast<int>(settings.planes.size()); ++p) {
      if (!settings.planes[p].moves) continue;
      const auto at = fields.find({true, key.a, p, false});
      writer.put(at == fields.end() ? Vec3{} : static_cast<const PlaneField &>(*at->second).kept_force());
    }
    found[key] = writer.take();
  }
  return found;
}

namespace {

// Whether all of a row from this byte on are finite numbers.
template <class Row> bool has_numbers(const Row &row, std::size_t from)
{
  double values[sizeof(Row) / sizeof(double)];
  const std::size_t bytes = sizeof(Row) - from;
  std::memcpy(values, reinterpret_cast<const std::uint8_t *>(&row) + from, bytes);
  return std::all_of(values, values + bytes / sizeof(double), [](double value) { return std::isfinite(value); });
}

bool has_point(const ContactBody &body, int point) { return point >= 0 && point < static_cast<int>(body.points().size()); }

std::vector<FieldContact> read_pair(ByteReader &reader, const ContactBody &owner, const ContactBody &host)
{
  std::vector<FieldContact> rows = reader.get_counted<FieldContact>();
  int before = -1;
  for (const FieldContact &row : rows) {
    if (!has_point(owner, row.point) || row.side < 0 || row.side >= host.sides() || host.is_line() ||
        !(host.frame() || host.is_filled(row.cell[0], row.cell[1], row.cell[2])))
      reader.fail("has points that there are not");
    if (row.point <= before) reader.fail("has points that do not ascend");
    if (!has_numbers(row, offsetof(FieldContact, state))) reader.fail("has a value that is not a number");
    before = row.point;
  }
  return rows;
}

// By planes.
std::vector<std::vector<PlaneContact>> read_planes(ByteReader &reader, const ContactBody &owner, std::size_t planes)
{
  std::vector<std::vector<PlaneContact>> of_plane(planes);
  std::pair<int, int> before{-1, -1};
  for (const PlaneContact &row : reader.get_counted<PlaneContact>()) {
    if (!has_point(owner, row.point) || row.plane < 0 || row.plane >= static_cast<int>(planes))
      reader.fail("has points or planes that there are not");
    if (std::pair{row.plane, row.point} <= before) reader.fail("has points that do not ascend");
    if (!has_numbers(row, offsetof(PlaneContact, state))) reader.fail("has a value that is not a number");
    before = {row.plane, row.point};
    of_plane[row.plane].push_back(row);
  }
  return of_plane;
}

}    // namespace

template <class Field, class Row> void ContactWorld::put(Fields &into, const FieldKey &key, std::vector<Row> rows)
{
  if (key.at_plane && rows.empty()) return;
  std::unique_ptr<ContactField> field = make(key);
  static_cast<Field &>(*field).restore(std::move(rows));
  into[key] = std::move(field);
}

ContactWorld::Fields ContactWorld::read(const StateRecords &records)
{
  Fields found;
  for (const auto &[key, bytes] : records) {
    const std::string what =
        key.b ? "objects " + std::to_string(key.a) + " and " + std::to_string(key.b) : "object " + std::to_string(key.a);
    ByteReader reader(bytes.data(), bytes.size(), "the record of " + what);
    const ContactObject *const one = with_id(key.a), *const other = key.b ? with_id(key.b) : one;
    if (!one || !other) reader.fail("is of an object that is not there");
    reader.expect_version(STATE_VERSION);
    if (key.b) {
      put<ObjectField>(found, {false, key.a, key.b, false}, read_pair(reader, *one->body, *other->body));
      put<ObjectField>(found, {false, key.a, key.b, true}, read_pair(reader, *other->body, *one->body));
    } else {
      int plane = 0;
      for (auto &rows : read_planes(reader, *one->body, settings.planes.size()))
        put<PlaneField>(found, {true, key.a, plane++, false}, std::move(rows));
      for (int p = 0; p < static_cast<int>(settings.planes.size()); ++p) {
        if (!settings.planes[p].moves) continue;
        const auto force = reader.get<Vec3>();
        if (!has_numbers(force, 0)) reader.fail("has a value that is not a number");
        const auto at = found.find({true, key.a, p, false});
        if (at != found.end()) static_cast<PlaneField &>(*at->second).restore_force(force);
      }
    }
    reader.expect_end();
  }
  return found;
}

void ContactWorld::restore(const StateRecords &records)
{
  Fields found = read(records);
  drop_lists();
  fields = std::move(found);
}

}    // namespace mdanim
