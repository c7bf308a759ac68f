// SPDX-License-Identifier: GPL-2.0-only
// The level rule and exact heights.

#include "liquid/automaton/level.h"

#include "numbers/counter_rng.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mdanim {

long Leveller::move(Cells &cells, std::uint64_t seed, std::uint64_t when, double rate, long at_least)
{
  bodies.search(cells);
  joined = false;
  unchanged = true;
  if (bodies.surely_level()) return 0;
  bodies.join();
  joined = true;
  collect(cells);
  const std::uint64_t key = draw_key(seed, when, Phase::LEVEL);
  long moved = 0;
  for (std::size_t b = 0; b < bodies.all.size(); ++b) {
    if (bodies.all[b].level()) continue;
    const double part = std::min(std::ceil(rate * bodies.all[b].exposed), 1e15);    // a long can hold it
    moved += move_in(b, cells, key, std::max({1L, static_cast<long>(part), at_least}));
  }
  unchanged = moved == 0;
  return moved;
}

// Gathers only cells that may be used; sources from the top down, targets from the bottom up.
void Leveller::collect(const Cells &cells)
{
  const auto add = [&](Groups &groups, int body, int x, int y, int z) {
    groups.added.push_back(
        {body, z, static_cast<std::uint32_t>(cells.number(x, y, z)), static_cast<std::uint32_t>(cells.at(x, y, z))});
  };
  for (const auto &e : bodies.excess) add(excess, bodies.body_of(e.x, e.y, e.z), e.x, e.y, e.z);
  for (int z = bodies.top; z > bodies.lowest; --z)
    for (int y = 0; y < cells.ny; ++y)
      bodies.each_exposed(y, z, [&](int body, int word, Bodies::Word bits) {
        if (z > bodies.all[body].lowest) each_bit(word, bits, [&](int x) { add(sources, body, x, y, z); });
      });
  for (int z = bodies.lowest; z <= std::min(bodies.top + 1, cells.nz - 1); ++z)
    for (int y = 0; y < cells.ny; ++y)
      bodies.each_beside(y, z, [&](int body, int word, Bodies::Word bits) {
        if (z < bodies.all[body].highest || bodies.all[body].excess > 0)
          each_bit(word, bits, [&](int x) { add(targets, body, x, y, z); });
      });
  for (Groups *groups : {&excess, &sources, &targets}) groups->group(bodies.all.size());
}

void Leveller::Groups::group(std::size_t count)
{
  start.assign(count + 2, 0);
  if (count == 1) {
    items.swap(added);
    added.clear();
    start[1] = items.size();
    return;
  }
  for (const Item &item : added) ++start[item.body + 2];
  for (std::size_t b = 2; b < count + 2; ++b) start[b] += start[b - 1];
  items.resize(added.size());
  // Afterwards start[b] is where the items of b start.
  for (const Item &item : added) items[start[item.body + 1]++] = item;
  added.clear();
}

long Leveller::move_in(std::size_t body, Cells &cells, std::uint64_t key, long most)
{
  Item *const giving = sources.begin(body), *const to = targets.begin(body);
  // Whether an earlier body has taken it.
  const auto taken = [&](const Item &item) { return cells.content[item.place] != 0; };
  Item *const end = std::remove_if(to, targets.end(body), taken);
  const long room = std::min<long>(most, end - to);

  const auto higher = [&](const Item &a, const Item &b) {
    return a.z != b.z ? a.z > b.z : draw(key, a.number) < draw(key, b.number);
  };
  long moved = 0;
  std::sort(excess.begin(body), excess.end(body), higher);
  for (Item *item = excess.begin(body); item != excess.end(body); ++item)
    for (std::uint8_t &content = cells.content[item->place]; content > 1 && moved < room; ++moved) --content;

  long sinking = 0;
  const long exposed = sources.end(body) - giving;
  while (sinking < exposed && moved < room && giving[sinking].z > to[moved].z) ++sinking, ++moved;

  draw_lots(giving, giving + exposed, sinking, key);
  for (long n = 0; n < sinking; ++n) cells.content[giving[n].place] = 0;
  draw_lots(to, end, moved, key);
  for (long n = 0; n < moved; ++n) cells.content[to[n].place] = 1;
  return moved;
}

// Brings `count` items to the front: all items of the layers that come first, and of the last one those with the lowest draws.
void Leveller::draw_lots(Item *from, Item *to, long count, std::uint64_t key)
{
  if (count == 0 || from + count == to || from[count - 1].z != from[count].z) return;
  const auto same_layer = [z = from[count].z](const Item &item) { return item.z == z; };
  Item *const first = std::find_if(from, from + count, same_layer);
  Item *const last = std::find_if_not(from + count, to, same_layer);
  lots.clear();
  for (Item *item = first; item != last; ++item) lots.push_back({draw(key, item->number), *item});
  // Draws under one key differ from cell to cell, so there are no ties.
  const auto lower = [](const auto &a, const auto &b) { return a.first < b.first; };
  const long wanted = from + count - first;
  std::nth_element(lots.begin(), lots.begin() + wanted, lots.end(), lower);
  for (long n = 0; n < wanted; ++n) first[n] = lots[n].second;
}

bool Leveller::heights(const Cells &cells, double *height, bool just_moved)
{
  constexpr double NO_HEIGHT = std::numeric_limits<double>::quiet_NaN();
  if (!(just_moved && unchanged)) {
    bodies.search(cells);
    joined = false;
  }
  if (!joined) bodies.join();
  joined = true;

  const int words = bodies.words();
  undecided.resize(static_cast<std::size_t>(cells.ny) * words);
  for (std::size_t n = 0; n < undecided.size(); ++n) undecided[n] = Bodies::mask(0, cells.nx - 1, n % words);
  std::fill_n(height, static_cast<std::size_t>(cells.ny) * cells.nx, 0.0);
  for (int z = bodies.top; z >= 0; --z)
    for (int y = 0; y < cells.ny; ++y) {
      double *const row = height + static_cast<std::size_t>(y) * cells.nx;
      Bodies::Word *const open = &undecided[static_cast<std::size_t>(y) * words];
      const Bodies::Word *const wet = bodies.liquid_row(y, z), *const above = bodies.empty_row(y, z + 1);
      Bodies::Word any = 0;
      for (int k = 0; k < words; ++k) any |= open[k] & wet[k];
      if (any == 0) continue;
      bodies.each_exposed(y, z, [&](int body, int word, Bodies::Word bits) {
        const Body &b = bodies.all[body];
        double level = b.deep ? -(z + 1.0) : NO_HEIGHT;
        const double cover = b.full + b.part;
        if (b.deep && b.level() && cover > 0.0) level = b.highest + b.full / cover;
        each_bit(word, bits & open[word], [&](int x) { row[x] = level; });
      });
      for (int k = 0; k < words; ++k) {
        each_bit(k, open[k] & wet[k] & ~above[k], [&](int x) { row[x] = NO_HEIGHT; });
        open[k] &= ~wet[k];
      }
    }
  for (int y = 0; y < cells.ny; ++y)
    forget_solid(cells, y, &undecided[static_cast<std::size_t>(y) * words], height + static_cast<std::size_t>(y) * cells.nx);
  for (int y = 0; y < cells.ny; ++y) pile_up(cells, y, height + static_cast<std::size_t>(y) * cells.nx);
  return std::all_of(bodies.all.begin(), bodies.all.end(), [](const Body &b) { return b.level(); });
}

// Where liquid is uneven, which is marked by minus the topmost layer: the units that a column holds above the solid cell below
// its liquid (or the floor), as if packed.
void Leveller::pile_up(const Cells &cells, int y, double *height)
{
  if (std::none_of(height, height + cells.nx, [](double h) { return h < 0.0; })) return;
  ends.resize(cells.nx);
  for (int x = 0; x < cells.nx; ++x) ends[x] = height[x] < 0.0 ? static_cast<std::int32_t>(-height[x]) : 0;
  bed.assign(cells.nx, 0);
  pile.assign(cells.nx, 0);
  for (int z = 0; z <= bodies.top; ++z) {
    const std::uint8_t *const open = &cells.open[cells.at(0, y, z)], *const content = &cells.content[cells.at(0, y, z)];
    const std::int32_t *const e = ends.data();
    std::int32_t *const b = bed.data(), *const p = pile.data();
#pragma GCC ivdep
    for (int x = 0; x < cells.nx; ++x) {
      const bool is_open = open[x] != Cells::SOLID, inside = z < e[x];
      b[x] = inside && !is_open ? z + 1 : b[x];
      p[x] = !inside ? p[x] : is_open ? p[x] + content[x] : 0;
    }
  }
  for (int x = 0; x < cells.nx; ++x)
    if (height[x] < 0.0) height[x] = std::min(bed[x] + pile[x], cells.nz);
}

// Dry columns of a row that hold solid cells have no height.
void Leveller::forget_solid(const Cells &cells, int y, Bodies::Word *dry, double *height)
{
  const int words = bodies.words();
  const auto forget = [&](int x) { height[x] = std::numeric_limits<double>::quiet_NaN(); };
  Bodies::Word left = 0;
  for (int k = 0; k < words; ++k) {
    Bodies::Word solid = 0;
    if (dry[k] == 0) continue;
    for (int z = 0; z <= bodies.top; ++z) solid |= ~(bodies.liquid_row(y, z)[k] | bodies.empty_row(y, z)[k]);
    each_bit(k, dry[k] & solid, forget);
    left |= dry[k] &= ~solid;
  }
  if (left == 0) return;
  holds_solid.assign(cells.nx, 0);
  for (int z = bodies.top + 1; z < cells.nz; ++z) {
    const std::uint8_t *const open = &cells.open[cells.at(0, y, z)];
    std::uint8_t *const holds = holds_solid.data();
#pragma GCC ivdep
    for (int x = 0; x < cells.nx; ++x) holds[x] |= static_cast<std::uint8_t>(~open[x]);
  }
  for (int k = 0; k < words; ++k)
    each_bit(k, dry[k], [&](int x) {
      if (holds_solid[x] != 0) forget(x);
    });
}

}    // namespace mdanim
