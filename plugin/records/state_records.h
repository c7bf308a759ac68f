// SPDX-License-Identifier: GPL-2.0-only
// Records of objects and of pairs of objects: the form shared by checkpoints, other instances and restart files.

#pragma once

#include "records/byte_writer.h"

#include <cstdint>
#include <map>
#include <tuple>

namespace mdanim {

// The objects (molecule IDs) of a record: two of them, a < b; one, (a, 0); or (0, 0) for a record of the whole, as that of the
// liquid.
struct StateKey {
  int a = 0, b = 0;
  bool operator<(const StateKey &other) const { return std::tie(a, b) < std::tie(other.a, other.b); }
};

// Records by ascending keys. The same state gives the same bytes on any number of ranks. They depend neither on how particles are
// numbered nor on which other objects there are. Each begins with a version number of its fix.
using StateRecords = std::map<StateKey, Bytes>;

// Records as three arrays: keys (R, 2), where the bytes of each begin (R + 1), bytes.
struct FlatState {
  std::int64_t records;
  const std::int32_t *key;
  const std::int64_t *first;
  const std::uint8_t *data;
};

std::int64_t bytes_of(const StateRecords &records);
void flatten(const StateRecords &records, std::int32_t *key, std::int64_t *first, std::uint8_t *data);
// Throws std::runtime_error when keys are not sorted, occur twice or are not keys, or when `first` does not ascend from 0.
StateRecords unflatten(const FlatState &flat);

}    // namespace mdanim
