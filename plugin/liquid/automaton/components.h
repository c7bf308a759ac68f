// SPDX-License-Identifier: GPL-2.0-only
// Bodies of liquid: which cells are connected, where they end, and whether anything in them can move.

#pragma once

#include "liquid/automaton/cells.h"

#include <algorithm>
#include <climits>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace mdanim {

// A body: cells with content, connected through faces. A cell is exposed if the cell above is open and empty, or if there is
// none, because a basin is open at the top. A cell is beside a body if it is open and empty, with a face in common.
struct Body {
  long exposed = 0;        // cells
  long excess = 0;         // units above 1 in a cell
  int highest = -1;        // layer of the highest exposed cell; -1 none
  int lowest = INT_MAX;    // layer of the lowest cell beside it
  long full = 0;           // exposed cells in the highest layer that stand on liquid
  long part = 0;           // exposed cells one layer lower
  bool deep = false;       // an exposed cell stands on liquid or on the floor
  bool level() const { return excess == 0 && highest <= lowest; }
};

// All bodies in a grid, found with one bit per cell. Buffers are kept from call to call.
class Bodies {
 public:
  using Word = std::uint64_t;    // 64 cells of a row, the lowest bit first
  struct Excess {
    int x, y, z, units;
  };

  // Reads the cells; all other functions are about the cells at this time.
  void search(const Cells &cells);
  // Whether all bodies are level, as far as that is known before join(): true is certain.
  bool surely_level() const { return excess.empty() && highest <= lowest; }
  // Finds the body of each cell, and describes the bodies. They are numbered by their first cells, counted from the top layer
  // down and in a layer along y, then x.
  void join();

  int top = -1;                  // highest layer with liquid; -1 none
  int lowest = 0;                // layer of the lowest cell beside a body, or nz; exposed cells: one deeper
  std::vector<Excess> excess;    // cells with more than one unit
  std::vector<Body> all;         // after join()

  const Word *liquid_row(int y, int z) const { return at(liquid, row_of(y, z)); }
  // Open and empty cells; in layers up to top + 1.
  const Word *empty_row(int y, int z) const { return at(empty, row_of(y, z)); }
  int words() const { return row_words; }
  static Word mask(int first, int last, int word);    // cells first..last

  // After join(): the body of a liquid cell.
  int body_of(int x, int y, int z) const;
  // Calls visit(body, word, bits) for the exposed cells of a row, body by body; bits of the word-th word.
  template <class Visit> void each_exposed(int y, int z, Visit visit) const;
  // The same for the cells beside each body; a cell beside two bodies is visited for each of them, once.
  template <class Visit> void each_beside(int y, int z, Visit visit);

 private:
  struct CellRun {    // liquid cells first..last of one row, or of neighbouring rows that are alike
    int first, last, body;
  };

  void read_row(const Cells &cells, int y, int z);
  void find_edge(int y, int z);
  void join_row(int row);
  bool share(int row, int other);
  void find_runs(int row);
  void link(int row, int other);
  int root(int run);
  void describe();

  int row_of(int y, int z) const { return (z + 1) * (ny + 2) + (y + 1); }
  // An empty word lies between rows, so that neighbours along x need no test of bounds.
  std::size_t word_of(int row) const { return 1 + static_cast<std::size_t>(row) * (row_words + 1); }
  Word *at(std::vector<Word> &grid, int row) const { return &grid[word_of(row)]; }
  const Word *at(const std::vector<Word> &grid, int row) const { return &grid[word_of(row)]; }

  int nx = 0, ny = 0, nz = 0, row_words = 0;
  std::vector<Word> liquid, empty, beside;
  int highest = -1;    // layer of the highest exposed cell

  std::vector<CellRun> runs;      // from the top layer down
  std::vector<int> parent;        // of runs: a forest with a tree per body
  std::vector<int> begin, end;    // of a row's runs
  std::vector<Word> seen;         // scratch of each_beside: bits of a row for every body
  std::vector<std::size_t> seen_at;
};

inline Bodies::Word Bodies::mask(int first, int last, int word)
{
  const int from = std::max(first - 64 * word, 0), to = std::min(last - 64 * word, 63);
  return from > to ? 0 : (~Word(0) << from) & (~Word(0) >> (63 - to));
}

template <class Visit> void Bodies::each_exposed(int y, int z, Visit visit) const
{
  const int row = row_of(y, z);
  const Word *wet = at(liquid, row), *dry = at(empty, row_of(y, z + 1));
  Word any = 0;
  for (int k = 0; k < row_words; ++k) any |= wet[k] & dry[k];
  if (any == 0) return;
  for (int r = begin[row]; r < end[row]; ++r)
    for (int k = runs[r].first / 64; k <= runs[r].last / 64; ++k) {
      const Word bits = wet[k] & dry[k] & mask(runs[r].first, runs[r].last, k);
      if (bits != 0) visit(runs[r].body, k, bits);
    }
}

template <class Visit> void Bodies::each_beside(int y, int z, Visit visit)
{
  const int row = row_of(y, z), layer = ny + 2;
  const Word *here = at(beside, row);
  Word any = 0;
  for (int k = 0; k < row_words; ++k) any |= here[k];
  if (any == 0) return;
  if (all.size() == 1) {
    for (int k = 0; k < row_words; ++k)
      if (here[k] != 0) visit(0, k, here[k]);
    return;
  }
  for (const int other : {row, row - 1, row + 1, row - layer, row + layer}) {
    const int reach = other == row ? 1 : 0;
    for (int r = begin[other]; r < end[other]; ++r) {
      const int first = std::max(runs[r].first - reach, 0), last = std::min(runs[r].last + reach, nx - 1);
      for (int k = first / 64; k <= last / 64; ++k) {
        const std::size_t place = static_cast<std::size_t>(runs[r].body) * row_words + k;
        const Word bits = here[k] & mask(first, last, k) & ~seen[place];
        if (bits == 0) continue;
        seen[place] |= bits;
        seen_at.push_back(place);
        visit(runs[r].body, k, bits);
      }
    }
  }
  for (const std::size_t place : seen_at) seen[place] = 0;
  seen_at.clear();
}

// Calls `visit` with the numbers x of the bits of a word.
template <class Visit> inline void each_bit(int word, Bodies::Word bits, Visit visit)
{
  for (; bits != 0; bits &= bits - 1) visit(64 * word + __builtin_ctzll(bits));
}

}    // namespace mdanim
