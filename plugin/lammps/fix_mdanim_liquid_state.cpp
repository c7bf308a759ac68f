// SPDX-License-Identifier: GPL-2.0-only
// State of the liquid: its records of the whole and of particles, when particles migrate and in restart files.

#include "lammps/fix_mdanim_liquid.h"

#include "atom.h"
#include "fmt/format.h"
#include "lammps.h"

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>

using namespace LAMMPS_NS;
using namespace mdanim;

static constexpr std::int64_t STATE_VERSION = 2;    // of rows of particles

// --- values of waves at particles go with them ---

void FixMdanimLiquid::grow_arrays(int most) { buoyancy.kept.resize(most); }

void FixMdanimLiquid::copy_arrays(int from, int to, int) { buoyancy.kept[to] = buoyancy.kept[from]; }

void FixMdanimLiquid::set_arrays(int i) { buoyancy.kept[i] = {}; }

int FixMdanimLiquid::pack_exchange(int i, double *into)
{
  std::memcpy(into, &buoyancy.kept[i], sizeof(InLiquid));
  return maxexchange;
}

int FixMdanimLiquid::unpack_exchange(int i, double *from)
{
  std::memcpy(static_cast<void *>(&buoyancy.kept[i]), from, sizeof(InLiquid));
  return maxexchange;
}

// --- state ---

StateRecords FixMdanimLiquid::pack() const
{
  StateRecords records{{StateKey{}, basin->state(buoyancy.ledger())}};
  if (!basin->acts_on_cells()) return records;
  ParticleRows rows(lmp, STATE_VERSION, sizeof(InLiquid));
  for (int i = 0; i < atom->nlocal; ++i)
    if (buoyancy.kept[i].waves.acts()) rows.add(i, &buoyancy.kept[i]);
  rows.pack(records);
  return records;
}

void FixMdanimLiquid::unpack(const StateRecords &records)
{
  const auto whole = records.find(StateKey{});
  if (whole == records.end() || (!basin->acts_on_cells() && records.size() != 1))
    throw std::runtime_error(fmt::format("the liquid's state is one record (0, 0){}, there are {} records",
                                         basin->acts_on_cells() ? " and those of objects" : "", records.size()));
  std::vector<InLiquid> kept(buoyancy.kept.size());
  if (basin->acts_on_cells()) {
    int bad = 0;
    ParticleRows(lmp, STATE_VERSION, sizeof(InLiquid)).unpack(records, [&](int i, const std::uint8_t *from) {
      std::memcpy(static_cast<void *>(&kept[i]), from, sizeof kept[i]);
      bad |= !(kept[i].waves.is_finite() && std::isfinite(kept[i].impulse_x + kept[i].impulse_y));
    });
    MPI_Allreduce(MPI_IN_PLACE, &bad, 1, MPI_INT, MPI_MAX, world);
    if (bad) throw std::runtime_error("the liquid's state of particles has a value that is not a number");
  }
  buoyancy.set_ledger(basin->set_state(whole->second.data(), whole->second.size()));
  outer_before = basin->impulses().outer;
  buoyancy.kept = std::move(kept);
  has_looked = true;
  asked = -1;
}

void FixMdanimLiquid::write_restart(FILE *file) { mdanim::write_restart(*this, lmp, name(), file); }

void FixMdanimLiquid::restart(char *buffer)
{
  mdanim::read_restart([this](const StateRecords &all) { unpack(all); }, lmp, name(), buffer);
}
