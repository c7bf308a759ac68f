// SPDX-License-Identifier: GPL-2.0-only
// Output of a basin with waves, and its state as bytes.

#include "liquid/waves/wave_basin.h"

#include "liquid/state_kind.h"
#include "liquid/waves/columns.h"
#include "records/byte_reader.h"
#include "records/byte_writer.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mdanim {

namespace {

constexpr StateKind KIND{"waves", 10.0};
constexpr std::uint8_t SOLID_CODE = 255;
constexpr double PUDDLE = 1.0 / 64.0;    // in cells: lower floors belong to the floor of the basin
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
    reader.expect_numbers(std::array{ledger.sum.work, ledger.sum.lost, ledger.power.work, ledger.power.lost, energy_at_start},
                          "an energy");
    for (const Vec3 &impulse : {account.basin, account.solids, account.came})
      reader.expect_numbers(std::array{impulse.x, impulse.y, impulse.z}, "an impulse");
  }
};

}    // namespace

double WaveBasin::bytes() const
{ return static_cast<double>(part.size()) * (2.0 * sizeof(int) + sizeof(std::uint16_t)) + push.bytes() + columns() * 600.0; }

long WaveBasin::solid_cells() const
{
  return std::count_if(part.begin(), part.end(), [](std::uint16_t p) { return 2 * p >= SolidParts::FULL; });
}

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

double WaveBasin::mean_level() const
{
  double all = 0.0;
  for (const double head : heads) all += head;
  return shape.low.z + shape.cell.z * all / columns();
}

// Finds heads of all columns; columns without liquid that solids hide get the mean of those around.
void WaveBasin::look()
{
  std::vector<int> unknown;
  for (int c = 0; c < columns(); ++c) {
    look_at_column(c);
    if (std::isnan(heads[c])) unknown.push_back(c);
  }
  for (const int c : fill_inward(heads, unknown, shape.nx, shape.ny)) heads[c] = 0.0;    // solid from wall to wall
  const double highest = heads.empty() ? 0.0 : *std::max_element(heads.begin(), heads.end());
  crest = 0.0;
  for (const double head : tops)
    if (head > crest) crest = head;
  top_layer = std::clamp(static_cast<int>(std::ceil(highest)), 0, shape.nz);
}

// Finds the head of the topmost liquid, NaN where there is none below a solid. Its top is given where there is no solid above it.
void WaveBasin::look_at_column(int column)
{
  const int spans = waves.exchange.spans_of(column);
  hollow[column] = 0;
  heads[column] = tops[column] = std::numeric_limits<double>::quiet_NaN();
  for (int n = spans - 1; n >= 0; --n) {
    const WaveExchange::SpanView span = waves.exchange.span_view(column, n);
    const bool last = n == spans - 1 && span.high == shape.nz;
    // A thin layer on a body is not a surface; dry ground on the open floor is one.
    const bool on_floor = n == 0 && last && span.floor < PUDDLE;
    if (!on_floor && span.volume < ON_BODY) continue;
    heads[column] = std::min(span.phi, shape.nz + 1.0);
    if (last) tops[column] = std::min(span.surface, shape.nz + 1.0);
    if (last) return;
    const WaveExchange::SpanView above = waves.exchange.span_view(column, spans - 1);
    hollow[column] = above.high == shape.nz && heads[column] > above.floor + 1.0;
    return;
  }
}

// At bodies, the surface around them: the head of the liquid below them is that of the pressure there.
double WaveBasin::smooth_height(int column) const
{
  const double around = push.state()[column];
  return shape.low.z + shape.cell.z * (mass[column] > 0.0 && !std::isnan(around) ? around : heads[column]);
}

void WaveBasin::surface(double *smooth, double *raw) const
{
  for (int c = 0; c < columns(); ++c) {
    smooth[c] = smooth_height(c);
    raw[c] = hollow[c] ? -std::numeric_limits<double>::infinity() : raw_height(c);
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
    for (int z = 0; z < shape.nz; ++z)
      out[static_cast<std::size_t>(z) * columns() + c] = 2 * part[part_number(c, z)] >= SolidParts::FULL ? SOLID_CODE : 0;
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
                           moving,
                           still_known,
                           wait,
                           gone,
                           slept,
                           travel,
                           energy_at_start,
                           account,
                           of_drops.size()};
  ByteWriter writer;
  writer.put(head).put_all(mass).put_all(afloat).put_all(push.state()).put_all(push.added_state());
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
  mass = masses;
  afloat = floating;
  push.state() = ambient;
  push.added_state() = added;
  std::fill(from_solids.begin(), from_solids.end(), 0);
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
  moving = static_cast<long>(head.moving);
  still_known = walled_for = head.still_known;
  part = waves.solids().part;
  marked = changed = CellBox();
  for (int y = 0; y < shape.ny; ++y)
    for (int x = 0; x < shape.nx; ++x)
      for (int z = 0; z < shape.nz; ++z)
        if (part[part_number(y * shape.nx + x, z)]) marked.take_in(x, y, z);
  look();
  return head.ledger;
}

}    // namespace mdanim
