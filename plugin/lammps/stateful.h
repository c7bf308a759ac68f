// SPDX-License-Identifier: GPL-2.0-only
// State of a fix besides positions, velocities and forces: the records shared by checkpoints, other instances and restart files.

#pragma once

#include "records/state_records.h"

#include "lmptype.h"

#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

namespace LAMMPS_NS {
class LAMMPS;
}

namespace mdanim {

// A fix with such a state. All ranks call all functions together.
class Stateful {
 public:
  // All records, on every rank.
  virtual StateRecords pack() const = 0;
  // Makes this the state; every rank passes the same. All particles must exist, and the setup of a run must follow. An object or
  // pair without a record is as at the beginning. Throws std::runtime_error on all ranks when records belong to another fix or to
  // particles that do not exist; then nothing has changed.
  virtual void unpack(const StateRecords &records) = 0;

  std::optional<StateRecords> packed;    // for state_c.cpp, kept from one call to the next

 protected:
  ~Stateful() = default;
};

// For Fix::write_restart and Fix::restart: LAMMPS's restart files hold the same bytes. `fix` begins messages.
void write_restart(const Stateful &state, LAMMPS_NS::LAMMPS *lmp, const std::string &fix, FILE *file);
using TakeRecords = std::function<void(const StateRecords &)>;
void read_restart(const TakeRecords &take, LAMMPS_NS::LAMMPS *lmp, const std::string &fix, const char *buffer);

// Values that a fix keeps for particles, as records of their objects, (a, 0): a row for each particle, with its tag counted from
// the lowest of the object and values of a fixed size.
class ParticleRows {
 public:
  // Made by all ranks together. All rows have `width` bytes of values.
  ParticleRows(LAMMPS_NS::LAMMPS *lmp, std::int64_t version, int width);

  // Gives the record of an object a head of any size, before its rows; all ranks give the same. Without it there are none.
  void begin(int object, Bytes head) { heads[object] = std::move(head); }
  // Adds a row of the local particle i, whose object is 1 or more; `from` has `width` bytes.
  void add(int i, const void *from);
  // Adds records of all rows of all ranks: rows sorted by tags. Throws std::runtime_error on all ranks when a tag occurs twice.
  void pack(StateRecords &into) const;

  // Calls visit(i, values) for every row of a local particle i. Skips records of other keys. Throws std::runtime_error on all
  // ranks, before any visit, when a record has another version or width, or is of particles that do not exist.
  using Visit = std::function<void(int, const std::uint8_t *)>;
  // Heads of records by objects, and how many rows each has.
  struct RowsHead {
    Bytes bytes;
    std::size_t rows;
  };
  using Heads = std::map<int, RowsHead>;
  // `found`: where records have heads.
  void unpack(const StateRecords &records, const Visit &visit, Heads *found = nullptr) const;

 private:
  struct StateRow {
    int object;
    std::int32_t tag;    // counted from the lowest of the object
    bool operator<(const StateRow &other) const { return std::tie(object, tag) < std::tie(other.object, other.tag); }
  };
  struct Object {
    int id;
    LAMMPS_NS::tagint lowest;    // lowest tag of the object
  };
  LAMMPS_NS::tagint lowest_tag(int object) const;

  LAMMPS_NS::LAMMPS *lmp;
  std::int64_t version;
  std::size_t width;
  std::vector<Object> objects;                         // of all ranks, by ascending IDs
  std::unordered_map<LAMMPS_NS::tagint, int> local;    // index of particles by tags; LAMMPS's own map may be out of date here
  std::vector<StateRow> rows;
  Bytes values;
  std::map<int, Bytes> heads;
};

}    // namespace mdanim
