// SPDX-License-Identifier: GPL-2.0-only

#include "liquid/waves/drops.h"

#include "liquid/waves/columns.h"
#include "liquid/waves/waves.h"
#include "numbers/counter_rng.h"
#include "records/byte_reader.h"
#include "records/byte_writer.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace mdanim {

namespace {

constexpr double STEEP = 0.35;      // sqrt(depth): excess of a surface's rise over its neighbours' before it sheds drops
constexpr double DEEPEST = 8.0;     // cells that count for that: a crown does not depend on deeper liquid
constexpr double SHED = 0.6;        // part of the excess that is shed
constexpr double LARGEST = 0.15;    // drop, in cells
constexpr double SMALLEST = 2e-3;
constexpr int AT_ONCE = 4;          // drops of a column and an update
constexpr double UNEVEN = 0.8;      // largest deviation of drops from their mean, as a part of it
constexpr double SCATTER = 0.35;    // of a drop's velocity, over that of its rise

// A random number from -1 to 1.
double scatter(std::uint64_t key, std::uint64_t number) { return static_cast<double>(draw(key, number) >> 11) * 0x1p-52 - 1.0; }

}    // namespace

void Drops::update(Waves &waves, double dt, std::uint64_t when)
{
  if (share <= 0.0 && drops.empty()) return;
  std::vector<double> from;    // heights
  for (const Drop &drop : drops) from.push_back(drop.x.z);
  fly(waves.solids(), dt);
  land(waves, from);
  if (share > 0.0 && !waves.at_rest()) leave(waves, dt, when);
  while (drops.size() > most) merge();
  waves.take_brought();    // what flies keeps its energy in the account
}

Units Drops::total() const
{
  Units sum = 0;
  for (const Drop &drop : drops) sum += drop.units;
  return sum;
}

double Drops::energy() const
{
  double sum = 0.0;
  for (const Drop &drop : drops) sum += static_cast<double>(drop.units) / UNITS_PER_CELL * (drop.x.z + 0.5 * dot(drop.v, drop.v));
  return sum;
}

Vec3 Drops::momentum() const
{
  Vec3 sum;
  for (const Drop &drop : drops) sum += static_cast<double>(drop.units) / UNITS_PER_CELL * drop.v;
  return sum;
}

// Sheds drops from columns whose surface rises much faster than those around.
void Drops::leave(Waves &waves, double dt, std::uint64_t when)
{
  std::vector<WaveExchange::Top> top(static_cast<std::size_t>(nx) * ny);
  for (int column = 0; column < nx * ny; ++column) top[column] = waves.exchange.top_of(column);
  const std::uint64_t key = draw_key(seed, when, Phase::DROPS);
  for (int y = 0; y < ny; ++y)
    for (int x = 0; x < nx; ++x) {
      const int column = y * nx + x;
      const WaveExchange::Top &own = top[column];
      double around = 0.0;
      int neighbours = 0;
      for (int side = 0; side < 4; ++side) {
        const int other = neighbour(column, side, nx, ny);
        if (other < 0) continue;
        around += std::max(0.0, top[other].rising);
        ++neighbours;
      }
      const double up = std::min(own.rising - around / std::max(1, neighbours), own.jet);
      const double excess = up - STEEP * std::sqrt(std::min(own.volume, DEEPEST));
      const double volume = std::min(SHED * share * excess * dt, 0.5 * own.volume);
      if (!(volume > SMALLEST)) continue;
      const int parts = std::clamp(static_cast<int>(std::ceil(volume / LARGEST)), 1, AT_ONCE);
      for (int n = 0; n < parts; ++n) {
        const std::uint64_t number = (static_cast<std::uint64_t>(column) * AT_ONCE + n) * 8;
        const auto random = [&](int k) { return scatter(key, number + k); };
        const double size = volume / parts * (1.0 + UNEVEN * random(5));
        const Units units = waves.exchange.take(column, own.head, static_cast<Units>(size * UNITS_PER_CELL));
        if (units == 0) continue;
        const double spread = SCATTER * up;
        drops.push_back({{x + 0.5 + 0.5 * random(0), y + 0.5 + 0.5 * random(1), own.head},
                         {own.u[0] + spread * random(2), own.u[1] + spread * random(3), up * (1.0 - SCATTER * (1.0 + random(4)))},
                         units});
      }
    }
}

// Walls and solids stop drops, which fall along them. Drops land on solids below them.
void Drops::fly(const SolidParts &solid, double dt)
{
  const auto is_solid = [&](const Vec3 &at) {
    if (!(at.z >= 0.0 && at.z < solid.nz)) return false;
    return 2 * solid.at(static_cast<int>(at.y) * nx + static_cast<int>(at.x), static_cast<int>(at.z)) >= SolidParts::FULL;
  };

  const auto stop = [](double &x, double &v, int cells) {
    if (x >= 0.0 && x < cells) return;
    x = x < 0.0 ? 0.0 : std::nextafter(static_cast<double>(cells), 0.0);
    v = 0.0;
  };
  // Along one axis after the other, each time from an open place.
  const auto go = [&](Drop &drop, double &x, double &v, double to) {
    const bool was_solid = is_solid(drop.x);
    const double from = x;
    x = to;
    if (was_solid || !is_solid(drop.x)) return;
    x = from;
    v = 0.0;
  };
  for (Drop &drop : drops) {
    const auto aside = [&](double &x, double &v, int cells) {
      double to = x + dt * v;
      stop(to, v, cells);
      go(drop, x, v, to);
    };
    aside(drop.x.x, drop.v.x, nx);
    aside(drop.x.y, drop.v.y, ny);
    const double to = drop.x.z + dt * (drop.v.z - 0.5 * dt);
    drop.v.z -= dt;
    if (to > drop.x.z)
      go(drop, drop.x.z, drop.v.z, to);
    else
      drop.x.z = to;
  }
}

// Into the span below the drop's last place; a drop without room there waits above it.
void Drops::land(Waves &waves, const std::vector<double> &from)
{
  std::size_t left = 0;
  for (std::size_t n = 0; n < drops.size(); ++n) {
    Drop &drop = drops[n];
    const int column = static_cast<int>(drop.x.y) * nx + static_cast<int>(drop.x.x);
    const double height = std::max(drop.x.z, from[n]), head = waves.exchange.head_below(column, height);
    if (drop.x.z <= head) {
      drop.units -= waves.exchange.give(column, height, drop.units, drop.v.x, drop.v.y);
      drop.x.z = head;
      drop.v.z = 0.0;
    }
    if (drop.units > 0) drops[left++] = drop;
  }
  drops.resize(left);
}

// Joins drops in pairs, with the momentum of both.
void Drops::merge()
{
  std::size_t left = 0;
  for (std::size_t n = 0; n + 1 < drops.size(); n += 2) {
    const Drop &a = drops[n], &b = drops[n + 1];
    const double part = static_cast<double>(b.units) / static_cast<double>(a.units + b.units);
    drops[left++] = {a.x + part * (b.x - a.x), a.v + part * (b.v - a.v), a.units + b.units};
  }
  if (drops.size() % 2) drops[left++] = drops.back();
  drops.resize(left);
}

std::vector<std::uint8_t> Drops::state() const { return ByteWriter().put_all(drops).take(); }

void Drops::set_state(const std::uint8_t *bytes, std::size_t size)
{
  ByteReader reader(bytes, size, "the state of the drops");
  if (size % sizeof(Drop))
    reader.fail("has " + std::to_string(size) + " bytes, that is not a multiple of " + std::to_string(sizeof(Drop)));
  std::vector<Drop> taken = reader.get_all<Drop>(size / sizeof(Drop));
  for (const Drop &drop : taken)
    if (drop.units <= 0 || !(drop.x.x >= 0.0 && drop.x.x < nx && drop.x.y >= 0.0 && drop.x.y < ny &&
                             std::isfinite(drop.x.z + drop.v.x + drop.v.y + drop.v.z)))
      reader.is_damaged("a drop of " + std::to_string(drop.units) + " units is at (" + std::to_string(drop.x.x) + ", " +
                        std::to_string(drop.x.y) + ", " + std::to_string(drop.x.z) + ")");
  drops.swap(taken);
}

}    // namespace mdanim
