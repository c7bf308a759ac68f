// SPDX-License-Identifier: GPL-2.0-only
// Boxes are united over ranks, and all ranks count the steps of all pairs alike.

#include "fix_mdanim_test_memory.h"

#include "geometry/boxes.h"

#include "atom.h"
#include "error.h"
#include "fmt/format.h"
#include "memory.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

using namespace LAMMPS_NS;
using namespace mdanim;

static constexpr std::int64_t STATE_VERSION = 1;
static constexpr int WAY_BYTES = 3 * sizeof(double);

FixMdanimTestMemory::FixMdanimTestMemory(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  if (narg != 6) error->all(FLERR, "fix mdanim/test/memory: write REACH K_PAIR K_OWN");
  reach = utils::numeric(FLERR, arg[3], false, lmp);
  k_pair = utils::numeric(FLERR, arg[4], false, lmp);
  k_own = utils::numeric(FLERR, arg[5], false, lmp);
  restart_global = 1;
  FixMdanimTestMemory::grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  for (int i = 0; i < atom->nlocal; ++i) FixMdanimTestMemory::set_arrays(i);
}

FixMdanimTestMemory::~FixMdanimTestMemory()
{
  atom->delete_callback(id, Atom::GROW);
  memory->destroy(way);
}

int FixMdanimTestMemory::setmask() { return FixConst::POST_FORCE; }

void FixMdanimTestMemory::setup(int) { push(); }

void FixMdanimTestMemory::post_force(int)
{
  remember();
  push();
}

// Velocities are those of the half step.
void FixMdanimTestMemory::remember()
{
  std::vector<Box> boxes;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    for (int d = 0; d < 3; ++d) way[i][d] += update->dt * atom->v[i][d];
    const int object = static_cast<int>(atom->molecule[i]);
    if (object < 1) continue;
    if (object >= static_cast<int>(boxes.size())) boxes.resize(object + 1);
    boxes[object].include(atom->x[i]);
  }
  int here = static_cast<int>(boxes.size()), most = 0;
  MPI_Allreduce(&here, &most, 1, MPI_INT, MPI_MAX, world);
  boxes.resize(most);
  MPI_Allreduce(MPI_IN_PLACE, boxes.data(), 6 * most, MPI_DOUBLE, MPI_MIN, world);
  std::map<StateKey, std::int64_t> now;
  for (const auto &[a, b] : meeting_pairs(boxes, reach)) {
    const auto before = steps.find({a, b});
    now[{a, b}] = before == steps.end() ? 1 : before->second + 1;
  }
  steps.swap(now);
}

void FixMdanimTestMemory::push()
{
  std::map<int, std::int64_t> pushed;    // in whole numbers: their sum has no order
  for (const auto &[pair, count] : steps) {
    pushed[pair.a] -= count;
    pushed[pair.b] += count;
  }
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    for (int d = 0; d < 3; ++d) atom->f[i][d] -= k_own * way[i][d];
    const auto found = pushed.find(static_cast<int>(atom->molecule[i]));
    if (found != pushed.end()) atom->f[i][0] += k_pair * static_cast<double>(found->second);
  }
}

// --- what particles take along ---

void FixMdanimTestMemory::grow_arrays(int most) { memory->grow(way, most, 3, "mdanim/test/memory:way"); }

void FixMdanimTestMemory::copy_arrays(int from, int to, int) { std::copy_n(way[from], 3, way[to]); }

void FixMdanimTestMemory::set_arrays(int i) { std::fill_n(way[i], 3, 0.0); }

int FixMdanimTestMemory::pack_exchange(int i, double *buffer)
{
  std::copy_n(way[i], 3, buffer);
  return 3;
}

int FixMdanimTestMemory::unpack_exchange(int i, double *buffer)
{
  std::copy_n(buffer, 3, way[i]);
  return 3;
}

// --- state ---

StateRecords FixMdanimTestMemory::pack() const
{
  StateRecords records;
  ParticleRows rows(lmp, STATE_VERSION, WAY_BYTES);
  for (int i = 0; i < atom->nlocal; ++i)
    if ((atom->mask[i] & groupbit) && atom->molecule[i] > 0) rows.add(i, way[i]);
  rows.pack(records);
  for (const auto &[pair, count] : steps) {
    const std::int64_t words[2] = {STATE_VERSION, count};
    const auto *bytes = reinterpret_cast<const std::uint8_t *>(words);
    records[pair].assign(bytes, bytes + sizeof words);
  }
  return records;
}

void FixMdanimTestMemory::unpack(const StateRecords &records)
{
  std::map<StateKey, std::int64_t> given;
  for (const auto &[key, record] : records) {
    if (key.a == 0) throw std::runtime_error("a record of the whole is not its own");
    if (key.b == 0) continue;
    std::int64_t words[2];
    if (record.size() != sizeof words)
      throw std::runtime_error(
          fmt::format("the record of objects ({}, {}) has {} bytes, not {}", key.a, key.b, record.size(), sizeof words));
    std::memcpy(words, record.data(), sizeof words);
    if (words[0] != STATE_VERSION)
      throw std::runtime_error(
          fmt::format("the record of objects ({}, {}) has version {}, {} is needed", key.a, key.b, words[0], STATE_VERSION));
    given[key] = words[1];
  }
  std::vector<double> ways(3 * static_cast<std::size_t>(atom->nlocal), 0.0);
  ParticleRows(lmp, STATE_VERSION, WAY_BYTES).unpack(records, [&](int i, const std::uint8_t *values) {
    std::memcpy(&ways[3 * static_cast<std::size_t>(i)], values, WAY_BYTES);
  });
  for (int i = 0; i < atom->nlocal; ++i) std::copy_n(&ways[3 * static_cast<std::size_t>(i)], 3, way[i]);
  steps.swap(given);
}

void FixMdanimTestMemory::write_restart(FILE *file)
{ mdanim::write_restart(*this, lmp, fmt::format("fix {} mdanim/test/memory", id), file); }

void FixMdanimTestMemory::restart(char *buffer)
{
  const auto take = [this](const StateRecords &all) { unpack(all); };
  mdanim::read_restart(take, lmp, fmt::format("fix {} mdanim/test/memory", id), buffer);
}
