// SPDX-License-Identifier: GPL-2.0-only
// Bodies of liquid: one bit per cell, runs along x, and a forest that joins runs of neighbouring rows.

#include "liquid/automaton/components.h"

#include <cstring>

namespace mdanim {

namespace {

constexpr int CHUNK = 64;    // cells read at a time: one word of bits
constexpr std::uint64_t ONES = 0x0101010101010101u, LOW7 = 0x7f7f7f7f7f7f7f7fu, HIGH = 0x8080808080808080u;

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the first byte of a word gives its lowest bit");

struct Bytes {
  std::uint64_t w[CHUNK / 8];

  // Cells beyond `size` read as 0.
  Bytes(const std::uint8_t *from, int size)
  {
    if (size >= CHUNK) {
      std::memcpy(w, from, CHUNK);
    } else {
      std::memset(w, 0, CHUNK);
      std::memcpy(w, from, size);
    }
  }
  bool all(std::uint64_t value) const
  {
    std::uint64_t differs = 0;
    for (const std::uint64_t v : w) differs |= v ^ value;
    return differs == 0;
  }
  // One bit per byte: whether it has any bit of `which` set.
  std::uint64_t bits(std::uint64_t which) const
  {
    std::uint64_t result = 0;
    for (int i = 0; i < CHUNK / 8; ++i) {
      const std::uint64_t v = w[i] & which;
      const std::uint64_t high = (((v & LOW7) + LOW7) | v) & HIGH;         // 0x80 in every byte that is not 0
      result |= (((high >> 7) * 0x0102040810204080u) >> 56) << (8 * i);    // gathered in the top byte
    }
    return result;
  }
};

bool any_liquid(const std::uint8_t *from, std::size_t size)
{
  std::uint8_t any = 0;
  for (std::size_t i = 0; i < size; ++i) any |= from[i];
  return any != 0;
}

}    // namespace

void Bodies::search(const Cells &cells)
{
  if (nx != cells.nx || ny != cells.ny || nz != cells.nz) {
    nx = cells.nx, ny = cells.ny, nz = cells.nz, row_words = (nx + 63) / 64;
    const std::size_t rows = static_cast<std::size_t>(ny + 2) * (nz + 2);
    for (std::vector<Word> *grid : {&liquid, &empty, &beside}) grid->assign(rows * (row_words + 1) + 1, 0);
    begin.assign(rows, 0);
    end.assign(rows, 0);
    // A basin is open at the top: liquid that reaches up to there is exposed.
    for (int y = 0; y < ny; ++y)
      for (int k = 0; k < row_words; ++k) at(empty, row_of(y, nz))[k] = mask(0, nx - 1, k);
  }
  excess.clear();
  all.clear();
  highest = -1, lowest = nz;
  const int old_top = top;
  for (top = nz - 1; top >= 0; --top)
    if (any_liquid(&cells.content[(top + 1) * cells.layer], cells.layer)) break;
  for (int z = 0; z <= std::min(std::max(top + 1, old_top), nz - 1); ++z)
    for (int y = 0; y < ny; ++y) read_row(cells, y, z);
  for (int z = 0; z <= std::min(top + 1, nz - 1); ++z)
    for (int y = 0; y < ny; ++y) find_edge(y, z);
  if (top == nz - 1) highest = top;
}

void Bodies::read_row(const Cells &cells, int y, int z)
{
  Word *wet = at(liquid, row_of(y, z)), *dry = at(empty, row_of(y, z));
  const std::size_t place = cells.at(0, y, z);
  for (int k = 0; k < row_words; ++k) {
    const int size = nx - CHUNK * k;
    const Bytes content(&cells.content[place + CHUNK * k], size);
    if (content.all(ONES)) {
      wet[k] = ~Word(0);
      dry[k] = 0;
      continue;
    }
    wet[k] = content.all(0) ? 0 : content.bits(~Word(0));
    const Bytes open(&cells.open[place + CHUNK * k], size);
    dry[k] = open.all(~Word(0)) ? ~wet[k] : open.bits(~Word(0)) & ~wet[k];
    if (wet[k] == 0) continue;
    const auto note = [&](int x) { excess.push_back({x, y, z, cells.content[place + x] - 1}); };
    each_bit(k, content.bits(~ONES), note);
  }
}

void Bodies::find_edge(int y, int z)
{
  const int row = row_of(y, z), layer = ny + 2;
  const Word *wet = at(liquid, row), *dry = at(empty, row);
  const Word *below = at(liquid, row - layer), *above = at(liquid, row + layer);
  const Word *left = at(liquid, row - 1), *right = at(liquid, row + 1);
  Word *edge = at(beside, row);
  Word next_to = 0, under = 0;
  for (int k = 0; k < row_words; ++k) {
    const Word along = wet[k] << 1 | wet[k - 1] >> 63 | wet[k] >> 1 | wet[k + 1] << 63;
    edge[k] = dry[k] & (along | left[k] | right[k] | below[k] | above[k]);
    next_to |= edge[k];
    under |= dry[k] & below[k];
  }
  if (next_to != 0) lowest = std::min(lowest, z);
  if (under != 0) highest = std::max(highest, z - 1);
}

void Bodies::join()
{
  runs.clear();
  parent.clear();
  std::fill(begin.begin(), begin.end(), 0);
  std::fill(end.begin(), end.end(), 0);
  for (int z = top; z >= 0; --z)
    for (int y = 0; y < ny; ++y) join_row(row_of(y, z));
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const int from = root(r);    // the first run of its body
    if (from == static_cast<int>(r)) {
      runs[r].body = all.size();
      all.emplace_back();
    } else
      runs[r].body = runs[from].body;
  }
  seen.assign(all.size() * row_words, 0);
  describe();
}

void Bodies::join_row(int row)
{
  const int above = row + ny + 2;
  if (share(row, above)) {
    // Under rows that were linked, rows with the same runs need no link.
    if (begin[row - 1] != begin[above - 1] || end[row - 1] != end[above - 1]) link(row, row - 1);
  } else {
    find_runs(row);
    link(row, row - 1);
    link(row, above);
  }
}

// Rows that are alike are connected cell by cell, and may share their runs.
bool Bodies::share(int row, int other)
{
  if (!std::equal(at(liquid, row), at(liquid, row) + row_words, at(liquid, other))) return false;
  begin[row] = begin[other];
  end[row] = end[other];
  return true;
}

void Bodies::find_runs(int row)
{
  const Word *wet = at(liquid, row);
  begin[row] = runs.size();
  for (int k = 0; k < row_words; ++k)
    for (Word rest = wet[k]; rest != 0;) {
      const int from = __builtin_ctzll(rest);
      const Word after = ~(rest >> from) & (~Word(0) >> from);    // the end of this run of ones
      const int to = (after == 0 ? 64 : from + __builtin_ctzll(after)) - 1;
      rest = to == 63 ? 0 : rest & (~Word(0) << (to + 1));
      if (from == 0 && begin[row] < static_cast<int>(runs.size()) && runs.back().last == CHUNK * k - 1)
        runs.back().last = CHUNK * k + to;
      else {
        parent.push_back(runs.size());
        runs.push_back({CHUNK * k + from, CHUNK * k + to, 0});
      }
    }
  end[row] = runs.size();
}

void Bodies::link(int row, int other)
{
  int a = begin[row], b = begin[other];
  while (a < end[row] && b < end[other]) {
    if (runs[a].first <= runs[b].last && runs[b].first <= runs[a].last) {
      const int p = root(a), q = root(b);
      parent[std::max(p, q)] = std::min(p, q);
    }
    ++(runs[a].last < runs[b].last ? a : b);
  }
}

int Bodies::root(int run)
{
  while (parent[run] != run) run = parent[run] = parent[parent[run]];
  return run;
}

void Bodies::describe()
{
  for (const Excess &e : excess) all[body_of(e.x, e.y, e.z)].excess += e.units;
  for (int z = top; z >= lowest - 1 && z >= 0; --z)
    for (int y = 0; y < ny; ++y) {
      const Word *below = at(liquid, row_of(y, z - 1));
      each_exposed(y, z, [&](int body, int word, Word bits) {
        Body &b = all[body];
        const int count = __builtin_popcountll(bits), on_liquid = __builtin_popcountll(bits & below[word]);
        if (b.highest < 0) b.highest = z;
        b.exposed += count;
        b.deep |= z == 0 || on_liquid > 0;
        if (z == b.highest) b.full += on_liquid;
        if (z == b.highest - 1) b.part += count;
      });
    }
  for (int z = std::min(top + 1, nz - 1); z >= lowest; --z)
    for (int y = 0; y < ny; ++y) each_beside(y, z, [&](int body, int, Word) { all[body].lowest = z; });
}

int Bodies::body_of(int x, int y, int z) const
{
  const int row = row_of(y, z);
  const auto run = std::lower_bound(runs.begin() + begin[row], runs.begin() + end[row], x,
                                    [](const CellRun &r, int cell) { return r.last < cell; });
  return run->body;
}

}    // namespace mdanim
