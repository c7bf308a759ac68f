// SPDX-License-Identifier: GPL-2.0-only
// Conversion of records to and from arrays.

#include "records/state_records.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace mdanim {

namespace {

std::string words(const StateKey &key) { return "(" + std::to_string(key.a) + ", " + std::to_string(key.b) + ")"; }

[[noreturn]] void fail(const std::string &why) { throw std::runtime_error(why); }

}    // namespace

std::int64_t bytes_of(const StateRecords &records)
{
  std::int64_t bytes = 0;
  for (const auto &[key, record] : records) bytes += static_cast<std::int64_t>(record.size());
  return bytes;
}

void flatten(const StateRecords &records, std::int32_t *key, std::int64_t *first, std::uint8_t *data)
{
  *first = 0;
  for (const auto &[objects, record] : records) {
    *key++ = objects.a;
    *key++ = objects.b;
    std::copy(record.begin(), record.end(), data + *first);
    first[1] = first[0] + static_cast<std::int64_t>(record.size());
    ++first;
  }
}

StateRecords unflatten(const FlatState &flat)
{
  StateRecords records;
  if (flat.records < 0 || flat.first[0] != 0)
    fail("the first of " + std::to_string(flat.records) + " records does not begin at 0");
  for (std::int64_t n = 0; n < flat.records; ++n) {
    const StateKey key{flat.key[2 * n], flat.key[2 * n + 1]};
    if (key.a < 0 || key.b < 0 || (key.b && (key.a == 0 || key.a >= key.b)))
      fail(words(key) + " are not two objects; a key is (a, b) with 0 < a < b, (a, 0) or (0, 0)");
    if (n && !(records.rbegin()->first < key))
      fail("records must be sorted by their keys and differ; " + words(key) + " comes after " + words(records.rbegin()->first));
    if (flat.first[n + 1] < flat.first[n]) fail("record " + words(key) + " ends before it begins");
    records.emplace_hint(records.end(), key, Bytes(flat.data + flat.first[n], flat.data + flat.first[n + 1]));
  }
  return records;
}

}    // namespace mdanim
