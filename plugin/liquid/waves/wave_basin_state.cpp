// SPDX-License-Identifier: GPL-2.0-only
// Output of a basin with waves, and its state as bytes.

#include "liquid/waves/wave_basin.h"

#include "liquid/state_kind.h"
#include "liquid/waves/columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace mdanim {

namespace {

constexpr StateKind KIND{"waves", 10.0};
constexpr std::uint8_t SOLID_CODE = 255;
constexpr double PUDDLE = 1.0 / 64.0;    // cells that are part of the floor
constexpr double PI = 3.14159265358979323846;

struct WaveBasinHead {
  StateKind kind;
  Basin::Ledger ledger;
  std::int64_t nx, ny, nz, units, updates, stale, moving;
  std::uint64_t still_known;
  Basin::Wait wait;
  double gone, slept;
  double travel, energy_at_start;
  Basin::Impulses account;
  std::uint64_t of_drops;    // bytes

  // Throws std::runtime_error.
  void check(const std::string &whose) const
  {
    need_numbers(std::array{wait.before, wait.dt, gone, slept, travel}, whose, "a time or a way", 0.0);
    need_numbers(std::array{units, updates, moving, wait.steps, wait.looked}, whose, "a count", 0.0);
    need_numbers(std::array{ledger.sum.work, ledger.sum.lost, ledger.power.work, ledger.power.lost, energy_at_start}, whose,
                 "an energy");
    for (const Vec3 &impulse : {account.basin, account.solids, account.came})
      need_numbers(std::array{impulse.x, impulse.y, impulse.z}, whose, "an impulse");
  }
};

// Copies of values that the bytes of a state hold, which may lie anywhere.
template <class Value> std::vector<Value> copied(const std::uint8_t *from, std::size_t count)
{
  std::vector<Value> values(count);
  if (count > 0) std::memcpy(static_cast<void *>(values.data()), from, count * sizeof values[0]);
  return values;
}

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

// Heads of all columns; those without liquid that solids hide have the mean of those around.
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

// The head of the topmost liquid, NaN where there is none below a solid. Its top is told where nothing is above it.
void WaveBasin::look_at_column(int column)
{
  const int spans = waves.spans_of(column);
  hollow[column] = 0;
  heads[column] = tops[column] = std::numeric_limits<double>::quiet_NaN();
  for (int n = spans - 1; n >= 0; --n) {
    const Waves::SpanView span = waves.span_view(column, n);
    const bool last = n == spans - 1 && span.high == shape.nz;
    // A little that stands on a body is not a surface; on the open floor dry ground is.
    const bool on_floor = n == 0 && last && span.floor < PUDDLE;
    if (!on_floor && span.volume < ON_BODY) continue;
    heads[column] = std::min(span.phi, shape.nz + 1.0);
    if (last) tops[column] = std::min(span.surface, shape.nz + 1.0);
    if (last) return;
    const Waves::SpanView above = waves.span_view(column, spans - 1);
    hollow[column] = above.high == shape.nz && heads[column] > above.floor + 1.0;
    return;
  }
}

// At bodies the surface around them: the head of the liquid below them is that of the pressure there.
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
    for (int n = 0; n < waves.spans_of(c); ++n) {
      const Waves::SpanView span = waves.span_view(c, n);
      if (!span.wet) continue;
      for (int z = span.low; z < span.high && z + 0.5 < span.phi; ++z) {
        std::uint8_t &cell = out[static_cast<std::size_t>(z) * columns() + c];
        if (cell != SOLID_CODE) cell = 1;
      }
    }
  }
}

// --- state ---

// The head, masses, what floats, heads and added masses of columns, the makers, the drops, the waves.
std::vector<std::uint8_t> WaveBasin::state(const Ledger &ledger) const
{
  const std::vector<std::uint8_t> of_makers = makers.state(), of_drops = drops.state(), of_waves = waves.state();
  const WaveBasinHead head{KIND,        ledger, shape.nx, shape.ny, shape.nz, units,           updates, stale,          moving,
                           still_known, wait,   gone,     slept,    travel,   energy_at_start, account, of_drops.size()};
  std::vector<std::uint8_t> bytes;
  const auto add = [&](const void *from, std::size_t size) {
    const auto *first = static_cast<const std::uint8_t *>(from);
    bytes.insert(bytes.end(), first, first + size);
  };
  add(&head, sizeof head);
  add(mass.data(), mass.size() * sizeof mass[0]);
  add(afloat.data(), afloat.size() * sizeof afloat[0]);
  add(push.state().data(), push.state().size() * sizeof push.state()[0]);
  add(push.added_state().data(), push.added_state().size() * sizeof push.added_state()[0]);
  add(of_makers.data(), of_makers.size());
  add(of_drops.data(), of_drops.size());
  add(of_waves.data(), of_waves.size());
  return bytes;
}

Basin::Ledger WaveBasin::set_state(const std::uint8_t *bytes, std::size_t size)
{
  const std::string whose = "the liquid's state ";
  const auto too_few = [&] { throw std::runtime_error(whose + "has " + std::to_string(size) + " bytes, that is too few"); };
  WaveBasinHead head;
  if (size < sizeof head) too_few();
  std::memcpy(&head, bytes, sizeof head);
  KIND.expect(head.kind, whose);
  if (head.nx != shape.nx || head.ny != shape.ny || head.nz != shape.nz)
    throw std::runtime_error(whose + "is of a grid of " + std::to_string(head.nx) + " x " + std::to_string(head.ny) + " x " +
                             std::to_string(head.nz) + " cells, this one has " + std::to_string(shape.nx) + " x " +
                             std::to_string(shape.ny) + " x " + std::to_string(shape.nz));
  std::size_t place = sizeof head;
  const auto skip = [&](std::size_t part_size) {
    if (size - place < part_size) too_few();
    const std::uint8_t *const from = bytes + place;
    place += part_size;
    return from;
  };
  const auto next = [&](auto value) { return copied<decltype(value)>(skip(columns() * sizeof value), columns()); };
  const std::size_t of_makers = makers.state().size();
  const std::vector<double> masses = next(0.0);
  const auto floating = next(AddedMass::Solids{});
  const std::vector<double> ambient = next(0.0);
  const auto added = next(AddedMass::Column{});
  const std::uint8_t *const made = skip(of_makers), *const flying = skip(head.of_drops);
  head.check(whose);
  need_numbers(masses, whose, "the mass of a column", 0.0);
  for (int c = 0; c < columns(); ++c) {
    need_numbers(std::array{floating[c].mass, added[c].mass}, whose, "the mass of a column", 0.0);
    need_numbers(std::array{floating[c].velocity, added[c].force, added[c].velocity}, whose, "the motion of a column");
    if (!std::isnan(ambient[c])) need_numbers(std::array{ambient[c]}, whose, "the head around a body");
  }
  Drops taken(drops);
  taken.set_state(flying, head.of_drops);
  WaveMakers(makers).set_state(made, of_makers);
  waves.set_state(bytes + place, size - place);    // which also tells other makers, by its size
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
