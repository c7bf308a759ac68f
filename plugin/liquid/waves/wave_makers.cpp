// SPDX-License-Identifier: GPL-2.0-only

#include "liquid/waves/wave_makers.h"

#include "liquid/waves/waves.h"
#include "numbers/portable.h"
#include "records/byte_reader.h"
#include "records/byte_writer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace mdanim {

namespace {

constexpr double ANY_HEIGHT = 1e9;
constexpr double TWO_PI = 6.283185307179586;
constexpr double MOST_DUE = 1e18;    // units: more than any basin holds, less than an integer of 64 bits can hold

// Solves w^2 = k tanh(k depth) for k.
double wave_number(double w, double depth)
{
  double k = w * w / std::sqrt(tangent_hyperbolic(w * w * depth));
  for (int n = 0; n < 30; ++n) {
    const double t = tangent_hyperbolic(k * depth), f = k * t - w * w;
    k -= f / (t + k * depth * (1.0 - t * t));
  }
  return k;
}

int columns_of(const WaveMakers::Mouth &mouth) { return (mouth.high[0] - mouth.low[0]) * (mouth.high[1] - mouth.low[1]); }

template <class F> void each_column(const WaveMakers::Mouth &mouth, int nx, const F &f)
{
  for (int y = mouth.low[1]; y < mouth.high[1]; ++y)
    for (int x = mouth.low[0]; x < mouth.high[0]; ++x) f(y * nx + x);
}

}    // namespace

WaveMakers::Mouth WaveMakers::along(SideOf side) const
{
  Mouth mouth{{0, 0}, {nx, ny}, ANY_HEIGHT};
  const int d = side == WEST || side == EAST ? 0 : 1, cells = d == 0 ? nx : ny;
  mouth.low[d] = side == WEST || side == SOUTH ? 0 : cells - 1;
  mouth.high[d] = mouth.low[d] + 1;
  return mouth;
}

void WaveMakers::add_inflow(const Mouth &mouth, double rate, double ux, double uy)
{
  makers.push_back({INFLOW, mouth, {}, rate, 0.0, {ux, uy}});
  due.push_back(0.0);
}

void WaveMakers::add_drain(const Mouth &mouth, double rate)
{
  makers.push_back({DRAIN, mouth, {}, rate, 0.0, {0.0, 0.0}});
  due.push_back(0.0);
}

void WaveMakers::add_paddle(SideOf side, double amplitude, double period, double depth)
{
  // Liquid that comes in at a wall runs away with the group velocity.
  const double w = TWO_PI / period, k = wave_number(w, depth), twice = 2.0 * k * depth;
  const double flux = amplitude * w / k * 0.5 * (1.0 + over_sine_hyperbolic(twice));
  const Mouth mouth = along(side);
  makers.push_back({PADDLE, mouth, {}, flux * columns_of(mouth), period, {0.0, 0.0}});
  due.push_back(0.0);
}

void WaveMakers::add_current(SideOf from, double speed)
{
  const SideOf to = from == WEST ? EAST : from == EAST ? WEST : from == SOUTH ? NORTH : SOUTH;
  const bool along_x = from == WEST || from == EAST;
  const double u = from == WEST || from == SOUTH ? speed : -speed;
  makers.push_back({CURRENT, along(from), along(to), speed, 0.0, {along_x ? u : 0.0, along_x ? 0.0 : u}});
  due.push_back(0.0);
}

void WaveMakers::apply(Waves &waves, double dt)
{
  const double start = account.time;
  account.time += dt;
  for (std::size_t n = 0; n < makers.size(); ++n) {
    const Maker &m = makers[n];
    double volume = m.rate * dt;    // volume that comes in, or goes out where it is negative
    if (m.kind == DRAIN) volume = -volume;
    if (m.kind == PADDLE) {
      // Volume in front of a paddle that starts in its first period.
      const auto pushed = [&](double time) {
        const double periods = time / m.period;
        return m.rate * m.period / TWO_PI * std::min(1.0, periods) * sine_of_turns(periods);
      };
      volume = pushed(account.time) - pushed(start);
    }
    if (m.kind == CURRENT) {
      volume = 0.0;
      each_column(m.drain, nx, [&](int column) { volume += m.rate * dt * waves.exchange.top_of(column).volume; });
    }
    due[n] = std::clamp(due[n] + volume * UNITS_PER_CELL, -MOST_DUE, MOST_DUE);
    const Units units = static_cast<Units>(due[n]);    // rounds towards 0
    due[n] -= static_cast<double>(units);
    const double ux = m.kind == PADDLE ? 0.0 : m.u[0], uy = m.kind == PADDLE ? 0.0 : m.u[1];
    if (m.kind == CURRENT) {
      const Units left = go(waves, m.drain, units), came = come(waves, m.mouth, left, ux, uy);
      come(waves, m.drain, left - came, ux, uy);
    } else if (units > 0)
      come(waves, m.mouth, units, ux, uy);
    else if (units < 0)
      go(waves, m.mouth, -units);
  }
}

// Gives the same to each column, and the remainder to the first ones; returns the units that found room.
Units WaveMakers::come(Waves &waves, const Mouth &mouth, Units units, double ux, double uy)
{
  const Units columns = columns_of(mouth);
  Units given = 0, n = 0;
  each_column(mouth, nx, [&](int column) {
    const Units part = units / columns + (n++ < units % columns);
    given += waves.exchange.give(column, mouth.height, part, ux, uy);
  });
  account.in += given;
  return given;
}

// Takes from each column in proportion to its content.
Units WaveMakers::go(Waves &waves, const Mouth &mouth, Units units)
{
  double all = 0.0;
  each_column(mouth, nx, [&](int column) { all += waves.exchange.held_below(column, mouth.height); });
  if (!(all > 0.0)) return 0;
  Units taken = 0;
  double sum = 0.0;
  Units wanted = 0;
  each_column(mouth, nx, [&](int column) {
    sum += waves.exchange.held_below(column, mouth.height);
    const Units until = static_cast<Units>(static_cast<double>(units) * (sum / all));
    taken += waves.exchange.take(column, mouth.height, until - wanted);
    wanted = until;
  });
  account.out += taken;
  return taken;
}

std::vector<std::uint8_t> WaveMakers::state() const { return ByteWriter().put(account).put_all(due).take(); }

void WaveMakers::set_state(const std::uint8_t *bytes, std::size_t size)
{
  ByteReader reader(bytes, size, "the state of the makers of waves");
  const std::size_t own = sizeof account + due.size() * sizeof(double);
  if (size != own) reader.fail("has " + std::to_string(size) + " bytes, these have " + std::to_string(own));
  const auto counted = reader.get<Account>();
  const auto owed = reader.get_all<double>(due.size());
  reader.expect_numbers(std::array{counted.time, static_cast<double>(counted.in), static_cast<double>(counted.out)},
                        "what came, or its time", 0.0);
  reader.expect_numbers(owed, "the part of a unit that is due", -1.0);
  account = counted;
  due = owed;
}

}    // namespace mdanim
