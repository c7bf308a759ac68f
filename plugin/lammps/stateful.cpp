// SPDX-License-Identifier: GPL-2.0-only
// Conversion of records to and from arrays, restart files, and rows of particles that are spread over ranks.

#include "lammps/stateful.h"

#include "lammps/object_table.h"
#include "lammps/rank_gather.h"
#include "records/byte_reader.h"
#include "records/byte_writer.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fmt/format.h"
#include "lammps.h"

#include <algorithm>
#include <climits>
#include <cstring>
#include <numeric>
#include <stdexcept>

using namespace LAMMPS_NS;

namespace mdanim {

namespace {

template <class... Words> [[noreturn]] void fail(const char *text, Words &&...words)
{ throw std::runtime_error(fmt::format(fmt::runtime(text), std::forward<Words>(words)...)); }

constexpr std::int64_t RESTART_VERSION = 1;

struct RestartHead {
  std::int64_t version, records, bytes;
};

}    // namespace

// --- restart files ---

void write_restart(const Stateful &state, LAMMPS *lmp, const std::string &fix, FILE *file)
{
  try {
    const StateRecords records = state.pack();
    if (lmp->comm->me != 0) return;
    const RestartHead head{RESTART_VERSION, static_cast<std::int64_t>(records.size()), bytes_of(records)};
    std::vector<std::int32_t> key(2 * records.size());
    std::vector<std::int64_t> first(records.size() + 1);
    Bytes data(head.bytes);
    flatten(records, key.data(), first.data(), data.data());
    const std::size_t size = sizeof head + 4 * key.size() + 8 * first.size() + data.size();
    if (size > INT_MAX) fail("its state of {:.3g} bytes does not fit into a restart file", static_cast<double>(size));
    const int words = static_cast<int>(size);
    fwrite(&words, sizeof words, 1, file);
    fwrite(&head, sizeof head, 1, file);
    fwrite(first.data(), sizeof first[0], first.size(), file);
    fwrite(key.data(), sizeof key[0], key.size(), file);
    fwrite(data.data(), 1, data.size(), file);
  } catch (const std::exception &problem) {
    lmp->error->one(FLERR, "{}: {}", fix, problem.what());
  }
}

void read_restart(const TakeRecords &take, LAMMPS *lmp, const std::string &fix, const char *buffer)
{
  try {
    // LAMMPS gives no size, so the head is trusted once its version is right.
    const auto *from = reinterpret_cast<const std::uint8_t *>(buffer);
    const auto head = ByteReader(from, sizeof(RestartHead), "its state in the restart file").get<RestartHead>();
    from += sizeof head;
    if (head.version != RESTART_VERSION)
      fail("its state in the restart file has version {}, {} is needed; write the file with this version of the plugin",
           head.version, RESTART_VERSION);
    // The buffer that LAMMPS gives is not aligned.
    std::vector<std::int64_t> first(head.records + 1);
    std::vector<std::int32_t> key(2 * head.records);
    std::memcpy(first.data(), from, 8 * first.size());
    std::memcpy(key.data(), from + 8 * first.size(), 4 * key.size());
    take(unflatten({head.records, key.data(), first.data(), from + 8 * first.size() + 4 * key.size()}));
  } catch (const std::exception &problem) {
    lmp->error->all(FLERR, "{}: {}", fix, problem.what());
  }
}

// --- rows of particles ---

ParticleRows::ParticleRows(LAMMPS *lmp, std::int64_t version, int width) : lmp(lmp), version(version), width(width)
{
  const Atom &atom = *lmp->atom;
  if (!atom.molecule) fail(NO_OBJECTS);
  std::vector<Object> here;
  for (int i = 0; i < atom.nlocal; ++i) {
    local.emplace(atom.tag[i], i);
    if (here.empty() || here.back().id != atom.molecule[i]) here.push_back({static_cast<int>(atom.molecule[i]), atom.tag[i]});
    here.back().lowest = std::min(here.back().lowest, atom.tag[i]);
  }
  objects = gather(lmp->world, here);
  std::sort(objects.begin(), objects.end(),
            [](const Object &p, const Object &q) { return std::tie(p.id, p.lowest) < std::tie(q.id, q.lowest); });
  const auto last = std::unique(objects.begin(), objects.end(), [](const Object &p, const Object &q) { return p.id == q.id; });
  objects.erase(last, objects.end());
}

tagint ParticleRows::lowest_tag(int id) const
{
  const auto found =
      std::lower_bound(objects.begin(), objects.end(), id, [](const Object &object, int wanted) { return object.id < wanted; });
  if (found == objects.end() || found->id != id) fail("there is no object {} (molecule ID)", id);
  return found->lowest;
}

void ParticleRows::add(int i, const void *from)
{
  const int object = static_cast<int>(lmp->atom->molecule[i]);
  rows.push_back({object, static_cast<std::int32_t>(lmp->atom->tag[i] - lowest_tag(object))});
  const auto *bytes = static_cast<const std::uint8_t *>(from);
  values.insert(values.end(), bytes, bytes + width);
}

void ParticleRows::pack(StateRecords &into) const
{
  const std::vector<StateRow> all = gather(lmp->world, rows);
  const Bytes all_values = gather(lmp->world, values);
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t p, std::size_t q) { return all[p] < all[q]; });
  for (std::size_t n = 0; n < order.size(); ++n) {
    const StateRow &row = all[order[n]];
    if (n && !(all[order[n - 1]] < row)) fail("particle {} of object {} has its state twice", row.tag, row.object);
    Bytes &record = into[{row.object, 0}];
    ByteWriter writer(std::move(record));
    if (writer.is_empty()) {
      writer.put(version);
      if (const auto head = heads.find(row.object); head != heads.end()) writer.put_counted(head->second);
    }
    writer.put(row.tag).put(all_values.data() + order[n] * width, width);
    record = writer.take();
  }
}

void ParticleRows::unpack(const StateRecords &records, const Visit &visit, Heads *found) const
{
  const auto every_row = [&](auto &&take) {
    for (const auto &[key, record] : records) {
      if (key.a == 0 || key.b != 0) continue;
      ByteReader reader(record.data(), record.size(), fmt::format("the record of object {}", key.a));
      const std::size_t size = sizeof(std::int32_t) + width;
      if (!found && (record.size() < sizeof version || (record.size() - sizeof version) % size))
        reader.fail(fmt::format("has {} bytes, not {} and a multiple of {}", record.size(), sizeof version, size));
      reader.expect_version(version);
      if (found) {
        Bytes head = reader.get_counted<std::uint8_t>();
        if (reader.left() % size) reader.fail(fmt::format("has {} bytes of rows, not a multiple of {}", reader.left(), size));
        (*found)[key.a] = {std::move(head), reader.left() / size};
      }
      const tagint lowest = lowest_tag(key.a);
      while (reader.left() > 0) {
        const auto here = local.find(lowest + reader.get<std::int32_t>());
        const bool is_local = here != local.end() && lmp->atom->molecule[here->second] == key.a;
        take(is_local ? here->second : -1, reader.skip(width));
      }
    }
  };
  bigint here = 0, rows_given = 0, all = 0;
  every_row([&](int i, const std::uint8_t *) {
    here += i >= 0;
    ++rows_given;
  });
  MPI_Allreduce(&here, &all, 1, MPI_LMP_BIGINT, MPI_SUM, lmp->world);
  if (all != rows_given) fail("of {} particles in the state {} are there", rows_given, all);
  every_row([&](int i, const std::uint8_t *from) {
    if (i >= 0) visit(i, from);
  });
}

}    // namespace mdanim
