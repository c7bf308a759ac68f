// SPDX-License-Identifier: GPL-2.0-only
// Output of a basin, and its state as bytes.

#include "liquid/automaton/automaton_basin.h"
#include "liquid/state_kind.h"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace mdanim {

static constexpr StateKind KIND{"automat", 4.0};
static constexpr std::uint8_t SOLID_CODE = 255, STILL_CODE = 254;

double AutomatonBasin::bytes() const
{ return 3.0 * static_cast<double>(cells().content.size()) + solid.bytes() + columns() * (2.0 * sizeof(double) + 1.0); }

double AutomatonBasin::mean_level() const
{
  double all = 0.0;
  for (const double h : eta) all += h;
  return shape.low.z + shape.cell.z * all / columns();
}

// Open cells without liquid right below a height; none where there is liquid above.
static int air_below(const Cells &cells, int x, int y, double height)
{
  const int first = std::min(static_cast<int>(height), cells.nz) - 1;
  for (int z = first + 1; z < cells.nz; ++z)
    if (cells.content[cells.at(x, y, z)]) return 0;
  int z = first;
  while (z >= 0 && cells.open[cells.at(x, y, z)] && !cells.content[cells.at(x, y, z)]) --z;
  return first - z;
}

// Of the columns without a height those with air below the surface count as kept dry, as a hull keeps its inside, where the
// air is two cells deep, and all around as far as it goes on: over what has just gone under the liquid closes a little late.
void AutomatonBasin::surface(double *smooth, double *raw) const
{
  const int nx = shape.nx;
  std::vector<int> air(columns(), 0), dry;
  for (int c = 0; c < columns(); ++c) {
    smooth[c] = smooth_height(c);
    raw[c] = raw_height(c);
    if (std::isnan(height[c])) air[c] = air_below(cells(), c % nx, c / nx, eta[c]);
    if (air[c] >= 2) dry.push_back(c);
  }
  while (!dry.empty()) {
    const int c = dry.back(), x = c % nx, y = c / nx;
    dry.pop_back();
    if (!air[c]) continue;
    air[c] = 0;
    raw[c] = -std::numeric_limits<double>::infinity();
    if (x > 0) dry.push_back(c - 1);
    if (x + 1 < nx) dry.push_back(c + 1);
    if (y > 0) dry.push_back(c - nx);
    if (y + 1 < shape.ny) dry.push_back(c + nx);
  }
}

void AutomatonBasin::contents(std::uint8_t *out) const
{
  cells().each([&](int x, int y, int z) {
    const std::size_t c = cells().at(x, y, z);
    *out++ = cells().open[c] ? cells().content[c] : SOLID_CODE;
  });
}

// --- state ---

namespace {

struct StateHead {
  StateKind kind;
  Basin::Ledger ledger;
  std::int64_t nx, ny, nz;
  std::int64_t units, swept, calm;
  Basin::Wait wait;
  double travel, crossed;
};

std::string number(std::int64_t n) { return std::to_string(n); }

std::string grid(std::int64_t nx, std::int64_t ny, std::int64_t nz)
{ return number(nx) + " x " + number(ny) + " x " + number(nz); }

}    // namespace

// The head, raw heights, and a byte for each cell: what it holds, or a code.
std::vector<std::uint8_t> AutomatonBasin::state(const Ledger &ledger) const
{
  const StateHead head{KIND, ledger, shape.nx, shape.ny, shape.nz, units, swept, calm, wait, travel, crossed};
  const std::size_t heights = height.size() * sizeof(double), count = solid.codes().size();
  std::vector<std::uint8_t> bytes(sizeof head + heights + count);
  std::memcpy(bytes.data(), &head, sizeof head);
  std::memcpy(bytes.data() + sizeof head, height.data(), heights);
  std::uint8_t *content = bytes.data() + sizeof head + heights;
  contents(content);
  for (std::size_t c = 0; c < count; ++c)
    if (content[c] == SOLID_CODE && solid.codes()[c] == SolidCells::STILL) content[c] = STILL_CODE;
  return bytes;
}

Basin::Ledger AutomatonBasin::set_state(const std::uint8_t *bytes, std::size_t size)
{
  StateHead head;
  const std::size_t heights = height.size() * sizeof(double), count = solid.codes().size();
  const std::string whose = "the liquid's state ";
  if (size < sizeof head) throw std::runtime_error(whose + "has " + std::to_string(size) + " bytes, that is too few");
  std::memcpy(&head, bytes, sizeof head);
  KIND.expect(head.kind, whose);
  if (head.nx != shape.nx || head.ny != shape.ny || head.nz != shape.nz || size != sizeof head + heights + count)
    throw std::runtime_error(whose + "is of a grid of " + grid(head.nx, head.ny, head.nz) + " cells, this one has " +
                             grid(shape.nx, shape.ny, shape.nz));
  const std::uint8_t *const content = bytes + sizeof head + heights;
  std::int64_t held = 0;
  for (std::size_t c = 0; c < count; ++c) {
    if (content[c] >= STILL_CODE) continue;
    if (content[c] > Cells::FULLEST) throw std::runtime_error(whose + "is damaged: a cell holds " + std::to_string(content[c]));
    held += content[c];
  }
  if (held != head.units)
    throw std::runtime_error(whose + "is damaged: it holds " + number(held) + " units of liquid, not " + number(head.units));
  need_numbers(std::array{head.travel, head.crossed, head.wait.before, head.wait.dt}, whose, "a time or a way", 0.0);
  need_numbers(std::array{head.swept, head.wait.steps, head.wait.looked}, whose, "a count", 0.0);
  need_numbers(std::array{head.ledger.sum.work, head.ledger.sum.lost, head.ledger.power.work, head.ledger.power.lost}, whose,
               "an energy");
  std::vector<double> stored(height.size());
  std::memcpy(stored.data(), bytes + sizeof head, heights);
  for (const double h : stored)
    if (!std::isnan(h)) need_numbers(std::array{h}, whose, "the height of a column", 0.0);
  units = head.units;
  swept = head.swept;
  wait = head.wait;
  calm = head.calm != 0;
  travel = head.travel;
  crossed = head.crossed;
  height = stored;

  // Solids first: an empty grid loses nothing to them.
  Cells &into = automaton.cells;
  std::fill(into.content.begin(), into.content.end(), 0);
  std::vector<std::uint8_t> codes(count, SolidCells::OPEN);
  for (std::size_t c = 0; c < count; ++c)
    if (content[c] >= STILL_CODE) codes[c] = content[c] == STILL_CODE ? SolidCells::STILL : SolidCells::MOVING;
  solid.assign(codes);
  automaton.displace(codes.data(), 0);
  into.each([&](int x, int y, int z) {
    const std::uint64_t c = into.number(x, y, z);
    if (codes[c] == SolidCells::OPEN) into.content[into.at(x, y, z)] = content[c];
  });
  automaton.touched();
  poured = true;
  smooth();
  return head.ledger;
}

}    // namespace mdanim
