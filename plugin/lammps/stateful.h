// SPDX-License-Identifier: GPL-2.0-only
// State of a fix besides positions, velocities and forces: as records that checkpoints, other instances and restart files hold
// alike.

#ifndef MDANIM_STATEFUL_H
#define MDANIM_STATEFUL_H

#include "records/state_records.h"

#include "lmptype.h"

#include <cstdint>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <tuple>
#include <unordered_map>
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
  // Makes this the state; every rank gives the same. All particles are there, and the setup of a run comes after. An object or
  // pair without a record is as at the beginning. Throws std::runtime_error on all ranks when records are not this fix's or are
  // of particles that there are not; then nothing has changed.
  virtual void unpack(const StateRecords &records) = 0;

  std::optional<StateRecords> packed;    // for state_c.cpp, from one call to the next

 protected:
  ~Stateful() = default;
};

// For Fix::write_restart and Fix::restart: LAMMPS's restart files hold the same bytes. `fix` begins messages.
void write_restart(const Stateful &state, LAMMPS_NS::LAMMPS *lmp, const std::string &fix, FILE *file);
void read_restart(Stateful &state, LAMMPS_NS::LAMMPS *lmp, const std::string &fix, const char *buffer);

// What a fix keeps of particles, as records of their objects, (a, 0): a row for each particle, its tag counted from the lowest of
// the object and values of a fixed size.
class ParticleRows {
 public:
  // All ranks make it together. All rows have `width` bytes of values.
  ParticleRows(LAMMPS_NS::LAMMPS *lmp, std::int64_t version, int width);

  // A row of the local particle i, whose object is 1 or more; `from` are `width` bytes.
  void add(int i, const void *from);
  // Adds records of all rows of all ranks: rows sorted by tags. Throws std::runtime_error on all ranks when one is there twice.
  void pack(StateRecords &into) const;

  // visit(i, values) for every row of a local particle i. Passes over records of other keys. Throws std::runtime_error on all
  // ranks, before any visit, when a record is of another version or width, or of particles that there are not.
  using Visit = std::function<void(int, const std::uint8_t *)>;
  void unpack(const StateRecords &records, const Visit &visit) const;

 private:
  struct StateRow {
    int object;
    std::int32_t tag;    // from the lowest of the object
    bool operator<(const StateRow &other) const { return std::tie(object, tag) < std::tie(other.object, other.tag); }
  };
  struct Object {
    int id;
    LAMMPS_NS::tagint lowest;    // tag
  };
  LAMMPS_NS::tagint lowest_tag(int object) const;

  LAMMPS_NS::LAMMPS *lmp;
  std::int64_t version;
  std::size_t width;
  std::vector<Object> objects;                         // of all ranks, by ascending IDs
  std::unordered_map<LAMMPS_NS::tagint, int> local;    // particles by tags; LAMMPS's own map may be older than they are here
  std::vector<StateRow> rows;
  Bytes values;
};

}    // namespace mdanim

#endif
