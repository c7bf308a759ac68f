// SPDX-License-Identifier: GPL-2.0-only
// The best cut, by dynamic programming, and its entries.

#include "passes/cutter.h"

#include <algorithm>
#include <limits>

namespace mdanim {

// Cost of a block besides its springs, in vectors of springs.
static constexpr int OVERHEAD = 2;
// Passes are used only when at least this part of the lanes has work.
static constexpr double WORTH_IT = 0.3;

// The chunk of each particle.
static std::vector<int> chunks(int particles, const int *object)
{
  std::vector<int> chunk(particles);
  for (int i = 1, first = 0; i < particles; ++i) {
    const bool full = i - first == Cut::CHUNK || object[i] != object[i - 1];
    if (full) first = i;
    chunk[i] = chunk[i - 1] + full;
  }
  return chunk;
}

// How many particles the best cut takes into the block that ends before particle i; index 1 … N.
std::vector<int> Cutter::lengths(const HalfBonds &bonds, const std::vector<int> &chunk) const
{
  const SpringRows &rows = *bonds.rows;
  const int particles = rows.size();
  std::vector<int> best(particles + 1);
  int farthest = 0;
  for (int i = 0; i < particles; ++i)
    for (const SpringRows::Link &link : rows[i]) farthest = std::max(farthest, link.offset);
  std::vector<int> seen(farthest + 1, -1);    // first particle of the latest block that has this offset
  std::vector<long> cost(particles + 1, std::numeric_limits<long>::max());
  cost[0] = 0;
  for (int i = 0; i < particles; ++i) {
    long offsets = 0;
    for (int n = 1; n <= width && i + n <= particles; ++n) {
      const int k = i + n - 1;
      if (chunk[k] != chunk[i]) break;
      for (const SpringRows::Link &link : rows[k]) {
        int &latest = seen[link.offset];
        offsets += latest != i;
        latest = i;
      }
      const long total = cost[i] + OVERHEAD + offsets;
      if (total <= cost[i + n]) {    // among equal costs the longer block, which comes later
        cost[i + n] = total;
        best[i + n] = n;
      }
    }
  }
  return best;
}

void Cutter::start(int lanes_of_blocks)
{
  width = lanes_of_blocks;
  coeffs = damped_coeffs = {};
  usual_rows = 0;
}

Cut Cutter::cut(const HalfBonds &bonds, const int *object)
{
  const SpringRows &rows = *bonds.rows;
  Cut cut;
  cut.particles = rows.size();
  cut.springs = rows.total();
  const std::vector<int> chunk = chunks(cut.particles, object), length = lengths(bonds, chunk);
  cut.chunks = cut.particles ? chunk.back() + 1 : 0;
  for (int end = cut.particles; end > 0; end -= length[end]) {
    Block block = {};
    block.start = end - length[end];
    block.lanes = static_cast<short>(length[end]);
    block.external_force = block.planes = block.crossing = block.immersed = -1;
    block.object = object[end - 1] - 1;
    block.chunk = chunk[end - 1];
    cut.block.push_back(block);
  }
  std::reverse(cut.block.begin(), cut.block.end());

  std::vector<bool> damped(cut.particles), bound(cut.particles);
  for (int i = 0; i < cut.particles; ++i)
    for (const SpringRows::Link &link : rows[i]) {
      bound[i] = bound[i + link.offset] = true;
      if (bonds.law[link.type].c > 0.0) damped[i] = damped[i + link.offset] = true;
    }

  std::vector<SpringRows::Links> left(width);    // springs of each lane
  std::vector<double> law(3 * width);
  for (Block &block : cut.block) {
    for (int lane = 0; lane < block.lanes; ++lane) {
      left[lane] = rows[block.start + lane];
      block.damped = block.damped || damped[block.start + lane];
      block.bound = block.bound || bound[block.start + lane];
    }
    for (;;) {
      int offset = 0;    // the longest offset that is left
      for (int lane = 0; lane < block.lanes; ++lane)
        if (left[lane].size()) offset = std::max(offset, left[lane].first->offset);
      if (offset == 0) break;
      std::fill(law.begin(), law.end(), 0.0);
      for (int lane = 0; lane < block.lanes; ++lane) {
        auto &[link, last] = left[lane];
        if (link == last || link->offset != offset) continue;
        const SpringCoeffs &own = bonds.law[link++->type];    // a second spring between the same two particles is another entry
        law[lane] = own.push;
        law[width + lane] = own.pull;
        if (block.damped) law[2 * width + lane] = own.c;
      }
      cut.entry.push_back({offset, add_row(block.damped, law.data())});
      cut.farthest = std::max(cut.farthest, offset);
    }
    block.end = static_cast<unsigned>(cut.entry.size());
  }
  return cut;
}

bool LaneUse::worth_it() const { return lanes > 0.0 && springs >= WORTH_IT * lanes; }

LaneUse Cutter::use(const Cut &cut) const
{ return {static_cast<double>(cut.springs), static_cast<double>(cut.entry.size() * width)}; }

Cut Cutter::join(const std::vector<const Cut *> &cuts)
{
  Cut all;
  for (const Cut *cut : cuts) {
    const unsigned first = static_cast<unsigned>(all.entry.size());
    for (Block block : cut->block) {
      block.start += all.particles;
      block.end += first;
      block.chunk += all.chunks;
      all.block.push_back(block);
    }
    all.entry.insert(all.entry.end(), cut->entry.begin(), cut->entry.end());
    all.particles += cut->particles;
    all.chunks += cut->chunks;
    all.springs += cut->springs;
    all.farthest = std::max(all.farthest, cut->farthest);
  }
  if (!usual_rows) usual_rows = coeffs.size() + damped_coeffs.size();
  return all;
}

bool Cutter::rows_pile_up() const
{
  constexpr unsigned MANY = 4;    // multiple of the usual number
  return coeffs.size() + damped_coeffs.size() > MANY * (usual_rows + 64);
}

}    // namespace mdanim
