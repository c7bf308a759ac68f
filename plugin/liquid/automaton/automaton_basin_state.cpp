// SPDX-License-Identifier: GPL-2.0-only
// Output of a basin, and its state as bytes.

#include "liquid/automaton/automaton_basin.h"
#include "liquid/state_kind.h"
#include "records/byte_reader.h"
#include "records/byte_writer.h"

#include <array>
#include <cmath>
#include <limits>

namespace mdanim {

static constexpr StateKind KIND{"automat", 4.0};
static constexpr std::uint8_t SOLID_CODE = 255, STILL_CODE = 254;

double AutomatonBasin::bytes() const
{ return 3.0 * static_cast<double>(cells().content.size()) + solid.bytes() + columns() * (2.0 * sizeof(double) + 1.0); }

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

// Columns without a height that have air below the surface count as kept dry, as the inside of a hull, where the air is two cells
// deep, and all around as far as it extends. Over a body that has just gone under, the liquid closes a little late.
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
  StateGrid grid;
  std::int64_t units, swept, calm;
  Basin::Wait wait;
  double travel, crossed;
};

}    // namespace

// The head, raw heights, and a byte for each cell: its content, or a code.
std::vector<std::uint8_t> AutomatonBasin::state(const Ledger &ledger) const
{
  const StateHead head{KIND, ledger, {shape.nx, shape.ny, shape.nz}, units, swept, calm, wait, travel, crossed};
  std::vector<std::uint8_t> content(solid.codes().size());
  contents(content.data());
  for (std::size_t c = 0; c < content.size(); ++c)
    if (content[c] == SOLID_CODE && solid.codes()[c] == SolidCells::STILL) content[c] = STILL_CODE;
  return ByteWriter().put(head).put_all(height).put_all(content).take();
}

Basin::Ledger AutomatonBasin::set_state(const std::uint8_t *bytes, std::size_t size)
{
  ByteReader reader(bytes, size, "the liquid's state");
  const auto head = reader.get<StateHead>();
  KIND.expect(head.kind, reader);
  StateGrid{shape.nx, shape.ny, shape.nz}.expect(head.grid, reader);
  const std::size_t count = solid.codes().size();
  const auto stored = reader.get_all<double>(height.size());
  const auto content = reader.get_all<std::uint8_t>(count);
  reader.expect_end();
  std::int64_t held = 0;
  for (const std::uint8_t of_cell : content) {
    if (of_cell >= STILL_CODE) continue;
    if (of_cell > Cells::FULLEST) reader.is_damaged("a cell holds " + std::to_string(of_cell));
    held += of_cell;
  }
  if (held != head.units)
    reader.is_damaged("it holds " + std::to_string(held) + " units of liquid, not " + std::to_string(head.units));
  reader.expect_numbers(std::array{head.travel, head.crossed, head.wait.before, head.wait.dt}, "a time or a way", 0.0);
  reader.expect_numbers(std::array{head.swept, head.wait.steps, head.wait.looked}, "a count", 0.0);
  reader.expect_numbers(std::array{head.ledger.sum.work, head.ledger.sum.lost, head.ledger.power.work, head.ledger.power.lost},
                        "an energy");
  for (const double h : stored)
    if (!std::isnan(h)) reader.expect_numbers(std::array{h}, "the height of a column", 0.0);
  units = head.units;
  swept = head.swept;
  wait = head.wait;
  calm = head.calm != 0;
  travel = head.travel;
  crossed = head.crossed;
  height = stored;

  // Solids first: an empty grid loses no liquid to them.
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
