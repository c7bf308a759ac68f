// SPDX-License-Identifier: GPL-2.0-only
// Output of a basin with waves, and its state as bytes.

#include "liquid/waves/wave_basin.h"

#include "liquid/state_kind.h"
#include "records/byte_reader.h"
#include "records/byte_writer.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mdanim {

namespace {

constexpr StateKind KIND{"waves", 11.0};
constexpr std::uint8_t SOLID_CODE = 255;
constexpr double PI = 3.14159265358979323846;

struct WaveBasinHead {
  StateKind kind;
  Basin::Ledger ledger;
  StateGrid grid;
  std::int64_t units, updates, stale, moving;
  std::uint64_t still_known;
  Basin::Wait wait;
  double gone, slept;
  double travel, energy_at_start;
  Basin::Impulses account;
  std::uint64_t of_drops;    // bytes

  void check(const ByteReader &reader) const
  {
    reader.expect_numbers(std::array{wait.before, wait.dt, gone, slept, travel}, "a time or a way", 0.0);
    reader.expect_numbers(std::array{units, updates, moving, wait.steps, wait.looked}, "a count", 0.0);
    reader.expect_numbers(
        std::array{ledger.sum.work, ledger.sum.lost, ledger.power.work, ledger.power.lost, energy_at_start, account.outer},
        "an energy");
    for (const Vec3 &impulse : {account.basin, account.solids, account.came})
      reader.expect_numbers(std::array{impulse.x, impulse.y, impulse.z}, "an impulse");
  }
};

}    // namespace

double WaveBasin::bytes() const { return solids.bytes() + push.bytes() + columns() * 600.0; }

double WaveBasin::energy_now() const
{
  const Waves::Energy now = waves.energy();
  return now.height + now.motion + drops.energy() + push.energy();
}

Vec3 WaveBasin::in_world(const Vec3 &momentum) const
{
  const double unit = cell_volume() / unit_of_time;
  return {momentum.x * unit * shape.cell.x, momentum.y * unit * shape.cell.y, 0.0};
}

void WaveBasin::find_heights() { heights.find(waves.exchange, shape.nz, solids.now().mass); }

// At bodies, the surface around them: the head of the liquid below them is that of the pressure there.
double WaveBasin::smooth_height(int column) const
{
  const double around = push.state()[column];
  return shape.low.z + shape.cell.z * (solids.now().mass[column] > 0.0 && !std::isnan(around) ? around : heights.head(column));
}

void WaveBasin::surface(double *smooth, double *raw) const
{
  for (int c = 0; c < columns(); ++c) {
    smooth[c] = smooth_height(c);
    raw[c] = heights.is_hollow(c) ? -std::numeric_limits<double>::infinity() : raw_height(c);
  }
}

std::vector<Basin::Droplet> WaveBasin::droplets() const
{
  std::vector<Droplet> found;
  found.reserve(drops.all().size());
  const Vec3 &low = shape.low, &cell = shape.cell;
  for (const Drops::Drop &drop : drops.all())
    found.push_back({{low.x + drop.x.x * cell.x, low.y + drop.x.y * cell.y, low.z + drop.x.z * cell.z},
                     std::cbrt(0.75 / PI * static_cast<double>(drop.units) / UNITS_PER_CELL * cell_volume())});
  return found;
}

void WaveBasin::contents(std::uint8_t *out) const
{
  for (int c = 0; c < columns(); ++c) {
    for (int z = 0; z < shape.nz; ++z) out[static_cast<std::size_t>(z) * columns() + c] = solids.is_solid(c, z) ? SOLID_CODE : 0;
    for (int n = 0; n < waves.exchange.spans_of(c); ++n) {
      const WaveExchange::SpanView span = waves.exchange.span_view(c, n);
      if (!span.wet) continue;
      for (int z = span.low; z < span.high && z + 0.5 < span.phi; ++z) {
        std::uint8_t &cell = out[static_cast<std::size_t>(z) * columns() + c];
        if (cell != SOLID_CODE) cell = 1;
      }
    }
  }
}

// --- state ---

// The head; masses, floating bodies, heads and added masses of columns; the makers, the drops, the waves.
std::vector<std::uint8_t> WaveBasin::state(const Ledger &ledger) const
{
  const Bytes of_drops = drops.state();
  const WaveBasinHead head{KIND,
                           ledger,
                           {shape.nx, shape.ny, shape.nz},
                           units,
                           updates,
                           stale,
                           solids.now().moving,
                           solids.now().still_known,
                           wait,
                           gone,
                           slept,
                           travel,
                           energy_at_start,
                           account,
                           of_drops.size()};
  ByteWriter writer;
  writer.put(head).put_all(solids.now().mass).put_all(solids.now().afloat).put_all(push.state()).put_all(push.added_state());
  return writer.put_all(makers.state()).put_all(of_drops).put_all(waves.state()).take();
}

Basin::Ledger WaveBasin::set_state(const std::uint8_t *bytes, std::size_t size)
{
  ByteReader reader(bytes, size, "the liquid's state");
  const auto head = reader.get<WaveBasinHead>();
  KIND.expect(head.kind, reader);
  StateGrid{shape.nx, shape.ny, shape.nz}.expect(head.grid, reader);
  const auto masses = reader.get_all<double>(columns());
  const auto floating = reader.get_all<AddedMass::Solids>(columns());
  const auto ambient = reader.get_all<double>(columns());
  const auto added = reader.get_all<AddedMass::Column>(columns());
  const std::size_t of_makers = makers.state().size();
  const std::uint8_t *const made = reader.skip(of_makers), *const flying = reader.skip(head.of_drops);
  head.check(reader);
  reader.expect_numbers(masses, "the mass of a column", 0.0);
  for (int c = 0; c < columns(); ++c) {
    reader.expect_numbers(std::array{floating[c].mass, added[c].mass}, "the mass of a column", 0.0);
    reader.expect_numbers(std::array{floating[c].velocity, added[c].force, added[c].velocity}, "the motion of a column");
    if (!std::isnan(ambient[c])) reader.expect_numbers(std::array{ambient[c]}, "the head around a body");
  }
  Drops taken(drops);
  taken.set_state(flying, head.of_drops);
  WaveMakers(makers).set_state(made, of_makers);
  const std::size_t of_waves = reader.left();
  waves.set_state(reader.skip(of_waves), of_waves);    // its size also reveals other makers
  drops = taken;
  makers.set_state(made, of_makers);
  solids.set({masses, floating, static_cast<long>(head.moving), head.still_known}, waves.solids());
  push.state() = ambient;
  push.added_state() = added;
  from_solids.clear();
  poured = true;
  stale = head.stale != 0;
  travel = head.travel;
  wait = head.wait;
  gone = head.gone;
  slept = head.slept;
  updates = head.updates;
  units = head.units;
  energy_at_start = head.energy_at_start;
  account = head.account;
  find_heights();
  return head.ledger;
}

}    // namespace mdanim
