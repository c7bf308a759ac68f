// SPDX-License-Identifier: GPL-2.0-only
// Wcislo 1999, sec. 4: the rules on single blocks and cells, and the choice of layers and blocks that they are applied to.

#include "liquid/automaton/automaton.h"

#include "liquid/automaton/automaton_rules.h"
#include "liquid/automaton/whole_layers.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <stdexcept>
#include <string>

namespace mdanim {

namespace {

std::array<std::array<Sources, 4>, 16> all_sources()
{
  std::array<std::array<Sources, 4>, 16> all;
  for (int open = 0; open < 16; ++open)
    for (int draw = 0; draw < 4; ++draw) all[open][draw] = horizontal_rule(open, draw);
  return all;
}

constexpr int SIDES[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};

const auto SOURCES = all_sources();

// Whether a block with solid corners can change all the same, by its open corners.
std::array<bool, 16> all_broken()
{
  std::array<bool, 16> all;
  for (int open = 0; open < 16; ++open) all[open] = open != 15 && SOURCES[open][2] != Sources{0, 1, 2, 3};
  return all;
}

const auto BROKEN = all_broken();

}    // namespace

// A cell that turned solid or open, or one that received liquid, with the number of units.
struct Automaton::Spill {
  int x, y, z;
  std::uint8_t units;
};

Automaton::Automaton(int nx, int ny, int nz, std::uint64_t seed, Vertical vertical)
    : cells(nx, ny, nz), seed(seed), vertical(vertical), even(make_blocks(0)), odd(make_blocks(-1)), layers(nz)
{ touched(); }

// ---- which blocks and layers ----

Automaton::Blocks Automaton::make_blocks(int first) const
{
  Blocks blocks;
  blocks.first = first;
  blocks.nx = first == 0 ? (cells.nx + 1) / 2 : cells.nx / 2 + 1;
  blocks.ny = first == 0 ? (cells.ny + 1) / 2 : cells.ny / 2 + 1;
  const std::size_t in_layer = static_cast<std::size_t>(blocks.nx) * blocks.ny;
  blocks.broken.resize(cells.nz);
  blocks.slot.assign(in_layer * cells.nz, -1);
  blocks.draws.resize(2 * in_layer);
  return blocks;
}

// Puts a block into the list of broken ones, or takes it out.
void Automaton::sort_block(Blocks &blocks, int bx, int by, int z)
{
  const std::size_t in_layer = static_cast<std::size_t>(blocks.nx) * blocks.ny;
  const std::size_t place = cells.at(blocks.first + 2 * bx, blocks.first + 2 * by, z);
  const int open = open_corners(&cells.open[place], cells.row);
  std::vector<Broken> &broken = blocks.broken[z];
  int *slot = &blocks.slot[z * in_layer];
  int &mine = slot[blocks.block(bx, by)];
  if (BROKEN[open]) {
    if (mine < 0) {
      mine = static_cast<int>(broken.size());
      broken.push_back(
          {static_cast<std::uint32_t>(place - z * cells.layer), static_cast<std::uint32_t>(blocks.block(bx, by)), 0});
    }
    broken[mine].open = static_cast<std::uint8_t>(open);
  } else if (mine >= 0) {
    broken[mine] = broken.back();
    slot[broken[mine].block] = mine;
    broken.pop_back();
    mine = -1;
  }
}

void Automaton::touched()
{
  for (Blocks *blocks : {&even, &odd})
    for (int z = 0; z < cells.nz; ++z)
      for (int by = 0; by < blocks->ny; ++by)
        for (int bx = 0; bx < blocks->nx; ++bx) sort_block(*blocks, bx, by, z);
  poured();
}

void Automaton::poured() { std::fill(layers.begin(), layers.end(), Layer{ANYTHING, false, false}); }

void Automaton::look(int z)
{
  const std::size_t first = (z + 1) * cells.layer;
  layers[z] = {whole_layers::look(&cells.content[first], &cells.open[first], cells.layer), true, false};
}

// A layer of one number throughout is the same after any permutation.
bool Automaton::mixes(const Layer &layer) { return layer.holds & MORE || layer.holds == (ZERO | ONE); }

// Whether a unit may pass between this layer and the next, by eq. (4.16).
bool Automaton::exchanges(const Layer &lower, const Layer &upper)
{ return lower.holds & MORE || (lower.holds & ZERO && upper.holds & (ONE | MORE)); }

// ---- a sweep ----

std::uint32_t Automaton::Blocks::word(int block, int z) const
{ return static_cast<std::uint32_t>(z / LAYERS_PER_WORD) * nx * ny + block; }

void Automaton::horizontal(Band &band, int z)
{
  if (z >= cells.nz || !mixes(band.layers[z])) return;
  Blocks &blocks = band.blocks;
  const int in_layer = blocks.nx * blocks.ny, own = band.first * blocks.nx, end = band.last * blocks.nx;
  std::uint16_t *const low = blocks.draws.data(), *const high = low + in_layer;
  if (band.group != z / LAYERS_PER_WORD) {
    band.group = z / LAYERS_PER_WORD;
    whole_layers::draw_words(blocks.key, blocks.word(own, z), end - own, low + own, high + own);
  }
  const int bits = 2 * (z % LAYERS_PER_WORD), shift = bits % 16;
  const std::uint16_t *const draws = bits < 16 ? low : high;
  const std::size_t first = cells.at(blocks.first, blocks.first + 2 * band.first, z);
  whole_layers::permute(&cells.content[first], &cells.open[first], cells.row, blocks.nx, band.last - band.first, draws + own,
                        shift);
  std::uint8_t *layer = &cells.content[z * cells.layer];
  for (const Broken &b : blocks.broken[z]) {
    const int block = static_cast<int>(b.block);
    if (block >= own && block < end) permute_block(layer + b.place, cells.row, SOURCES[b.open][draws[block] >> shift & 3]);
  }
}

void Automaton::vertical_pair(Band &band, int z)
{
  if (z < 0 || z + 1 >= cells.nz || !exchanges(band.layers[z], band.layers[z + 1])) return;
  const auto row_of = [&](int block) { return std::clamp(band.blocks.first + 2 * block, 0, cells.ny); };
  const int low = row_of(band.first), rows = row_of(band.last) - low;
  const std::size_t lower = cells.at(-1, low, z), upper = lower + cells.layer;
  const auto exchange =
      vertical == Vertical::LOWER ? whole_layers::exchange<Vertical::LOWER> : whole_layers::exchange<Vertical::ANY>;
  if (exchange(&cells.content[lower], &cells.content[upper], &cells.open[lower], &cells.open[upper],
               static_cast<std::size_t>(rows) * cells.row))
    band.layers[z] = band.layers[z + 1] = {ANYTHING, false, true};
}

// Time of one thread for a sweep, approximately [ns].
double Automaton::cost_of_sweep() const
{
  constexpr double CELL = 0.25;
  int changing = 0;
  for (const Layer &layer : layers) changing += mixes(layer) || layer.moved;
  return CELL * changing * static_cast<double>(cells.layer);
}

void Automaton::sweep(std::uint64_t when)
{
  constexpr double LOOK = 0.05;    // at a cell [ns], approximately
  // A layer that keeps changing is not worth a look.
  threads.parts(cells.nz, LOOK * static_cast<double>(cells.layer), [this](long from, long to) {
    for (int z = static_cast<int>(from); z < to; ++z) {
      if (!layers[z].known && !layers[z].moved) look(z);
      layers[z].moved = false;
    }
  });
  even.key = draw_key(seed, when, Phase::EVEN_BLOCKS);
  odd.key = draw_key(seed, when, Phase::ODD_BLOCKS);
  if (threads.pays(cost_of_sweep())) return sweep_in_bands();
  // All four steps in one pass, while a layer is still in the cache: each needs only results that are ready by then.
  Band evens{even, 0, even.ny, layers.data()}, odds{odd, 0, odd.ny, layers.data()};
  for (int z = 0; z <= cells.nz; z += 2) {
    horizontal(evens, z);
    horizontal(evens, z + 1);
    vertical_pair(evens, z);
    horizontal(odds, z);
    horizontal(odds, z + 1);
    vertical_pair(odds, z - 1);
  }
}

// Blocks of a horizontal step lie in one band each, and so do the cells one above the other of the vertical step after it. A band
// of the odd blocks lies half in one and half in another band of the even ones, so these are all swept before.
void Automaton::sweep_in_bands()
{
  each_band(even, [this](Band &band) {
    for (int z = 0; z < cells.nz; z += 2) {
      horizontal(band, z);
      horizontal(band, z + 1);
      vertical_pair(band, z);
    }
  });
  each_band(odd, [this](Band &band) {
    for (int z = 0; z <= cells.nz; z += 2) {
      horizontal(band, z);
      horizontal(band, z + 1);
      vertical_pair(band, z - 1);
    }
  });
}

template <class Sweep> void Automaton::each_band(Blocks &blocks, const Sweep &sweep)
{
  constexpr int OF_THREAD = 2;
  const int bands = std::min({OF_THREAD * threads.many(), Team::MOST_TASKS, blocks.ny});
  std::vector<std::vector<Layer>> known(bands, layers);
  threads.each(bands, cost_of_sweep(), [&](int n) {
    Band band{blocks, blocks.ny * n / bands, blocks.ny * (n + 1) / bands, known[n].data()};
    sweep(band);
  });
  for (const std::vector<Layer> &of_band : known)
    for (int z = 0; z < cells.nz; ++z)
      if (of_band[z].moved) layers[z] = of_band[z];
}

// ---- displacement and filling ----

// Finds a cell for the liquid of a newly solid one and notes it in `arrived`; false when there is none.
bool Automaton::expel(const Spill &spill, std::uint64_t key, std::vector<Spill> &arrived)
{
  const int x = spill.x, y = spill.y, z = spill.z;
  const std::uint64_t lot = draw(key, cells.number(x, y, z));
  const auto has_room = [&](std::size_t place) {
    return cells.open[place] && cells.content[place] + spill.units <= Cells::FULLEST;
  };
  const auto pour = [&](const Spill &s) {
    arrived.push_back(s);
    cells.content[cells.at(s.x, s.y, s.z)] += s.units;
    return true;
  };

  // The rim is solid, so a neighbour may lie outside.
  Spill beside[6];
  int sides = 0;
  for (const auto &[dx, dy, dz] : SIDES) {
    beside[sides] = {x + dx, y + dy, z + dz, spill.units};
    sides += has_room(cells.at(x + dx, y + dy, z + dz));
  }
  if (sides) return pour(beside[lot % sides]);

  const int farthest = std::max({cells.nx, cells.ny, cells.nz}) - 1;
  std::vector<Spill> found;
  for (int d = 1; d <= farthest; ++d) {
    for (int w = std::max(z - d, 0); w <= std::min(z + d, cells.nz - 1); ++w)
      for (int v = std::max(y - d, 0); v <= std::min(y + d, cells.ny - 1); ++v) {
        const std::size_t row = cells.at(0, v, w);
        const auto offer = [&](int u) {
          if (has_room(row + u)) found.push_back({u, v, w, spill.units});
        };
        if (std::abs(w - z) == d || std::abs(v - y) == d) {
          const int low = std::max(x - d, 0), high = std::min(x + d, cells.nx - 1);
          // Most of the shells around inner cells of a solid are solid throughout.
          if (std::memchr(&cells.open[row + low], Cells::OPEN, high - low + 1))
            for (int u = low; u <= high; ++u) offer(u);
        } else {
          if (x - d >= 0) offer(x - d);
          if (x + d < cells.nx) offer(x + d);
        }
      }
    if (!found.empty()) return pour(found[lot % found.size()]);
  }
  return false;
}

long Automaton::displace(const std::uint8_t *solid, std::uint64_t when)
{
  constexpr double CELL = 0.2;    // per cell that is not different [ns], approximately
  struct Changes {
    std::vector<Spill> turned;
    std::vector<std::size_t> stilled;
  };
  std::vector<Changes> of_layer(cells.nz);
  threads.parts(cells.nz, CELL * static_cast<double>(cells.layer), [&](long from, long to) {
    for (int z = static_cast<int>(from); z < to; ++z)
      for (int y = 0; y < cells.ny; ++y) {
        const std::size_t first = cells.at(0, y, z);
        const std::uint8_t *const now = solid + cells.number(0, y, z);
        if (!whole_layers::differ(now, &cells.open[first], &cells.still[first], cells.nx)) continue;
        for (int x = 0; x < cells.nx; ++x) {
          const std::size_t place = first + x;
          if ((now[x] == 2) != (cells.still[place] != 0)) {
            cells.still[place] ^= 1;
            of_layer[z].stilled.push_back(place);
          }
          if ((now[x] == 0) == (cells.open[place] != 0)) continue;
          of_layer[z].turned.push_back({x, y, z, cells.content[place]});
          cells.open[place] ^= Cells::OPEN;
          cells.content[place] = 0;
        }
      }
  });
  std::vector<Spill> turned, arrived;
  std::vector<std::size_t> stilled;
  for (const Changes &changes : of_layer) {
    turned.insert(turned.end(), changes.turned.begin(), changes.turned.end());
    stilled.insert(stilled.end(), changes.stilled.begin(), changes.stilled.end());
  }

  const std::uint64_t key = draw_key(seed, when, Phase::DISPLACEMENT);
  for (const Spill &spill : turned) {
    if (spill.units == 0 || expel(spill, key, arrived)) continue;
    for (const Spill &s : arrived) cells.content[cells.at(s.x, s.y, s.z)] -= s.units;
    for (const Spill &s : turned) {
      cells.open[cells.at(s.x, s.y, s.z)] ^= Cells::OPEN;
      cells.content[cells.at(s.x, s.y, s.z)] = s.units;
    }
    for (std::size_t place : stilled) cells.still[place] ^= 1;
    const auto number = [](int n) { return std::to_string(n); };
    throw std::runtime_error("a solid fills cell (" + number(spill.x) + ", " + number(spill.y) + ", " + number(spill.z) +
                             ") of the basin and there is no room for the " + number(spill.units) +
                             " units of liquid in it; enlarge the basin or lower the " + "liquid's level");
  }

  for (const Spill &s : turned) {
    for (Blocks *blocks : {&even, &odd}) sort_block(*blocks, (s.x - blocks->first) / 2, (s.y - blocks->first) / 2, s.z);
    layers[s.z] = {ANYTHING, false, false};
  }
  for (const Spill &s : arrived) layers[s.z] = {ANYTHING, false, false};
  return static_cast<long>(turned.size());
}

long Automaton::fill(long units, const std::uint8_t *within, std::uint64_t when)
{
  const std::uint64_t key = draw_key(seed, when, Phase::FILL);
  using Ticket = std::pair<std::uint64_t, std::size_t>;    // draw, place
  std::vector<Ticket> tickets;
  for (int z = 0; z < cells.nz && units > 0; ++z) {
    tickets.clear();
    for (int y = 0; y < cells.ny; ++y)
      for (int x = 0; x < cells.nx; ++x) {
        const std::size_t place = cells.at(x, y, z);
        const std::uint64_t number = cells.number(x, y, z);
        if (cells.open[place] && cells.content[place] == 0 && (!within || within[number]))
          tickets.push_back({draw(key, number), place});
      }
    if (static_cast<long>(tickets.size()) > units) {
      std::nth_element(tickets.begin(), tickets.begin() + units, tickets.end());
      tickets.resize(units);
    }
    for (const Ticket &ticket : tickets) cells.content[ticket.second] = 1;
    units -= static_cast<long>(tickets.size());
  }
  poured();
  return units;
}

long Automaton::total() const
{
  long units = 0;
  // Layer by layer, so that sums fit into the narrower numbers of which a vector holds more.
  for (std::size_t layer = 0; layer < cells.content.size(); layer += cells.layer)
    units += std::accumulate(&cells.content[layer], &cells.content[layer] + cells.layer, std::uint32_t{0});
  return units;
}

long Automaton::count_solid() const
{
  const long open = std::count(cells.open.begin(), cells.open.end(), Cells::OPEN);
  return static_cast<long>(cells.nx) * cells.ny * cells.nz - open;
}

}    // namespace mdanim
