// SPDX-License-Identifier: GPL-2.0-only

#include "liquid/waves/span.h"

#include "liquid/waves/columns.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace mdanim {

namespace {

double share(int part) { return part / static_cast<double>(SolidParts::FULL); }

// Whether a span owns the open part of the cell below it, or above it. Of one shut cell between two spans the upper one owns it.
bool has_below(const SolidParts &solid, int column, int low) { return low > 0 && solid.shut(column, low - 1); }
bool has_above(const SolidParts &solid, int column, int high)
{ return high < solid.nz && solid.shut(column, high) && solid.shut(column, high + 1); }

// The open part of a cell of a span, and the heights between which the cell takes liquid in.
struct Slice {
  double low, high, open;
};

Slice slice(const SolidParts &solid, const Span &span, int z)
{
  Slice s{static_cast<double>(z), z + 1.0, share(SolidParts::FULL - solid.at(span.column, z))};
  if (z == span.low) {
    s.low = span.floor;
    if (has_below(solid, span.column, z)) s.open += share(SolidParts::FULL - solid.at(span.column, z - 1));
  }
  if (z == span.high - 1) {
    s.high = span.roof;
    if (has_above(solid, span.column, span.high)) s.open += share(SolidParts::FULL - solid.at(span.column, span.high));
  }
  return s;
}

Span cut(const SolidParts &solid, int column, int low, int high)
{
  Span span{column, low, high, low + 1, true, static_cast<double>(low), static_cast<double>(high), 0};
  const auto part = [&](int z) { return solid.at(column, z); };
  for (int z = low; z < high; ++z) span.capacity += (SolidParts::FULL - part(z)) * SolidParts::UNITS;
  while (span.clear < high - 1 && !part(span.clear)) ++span.clear;
  span.plain = span.clear >= high - 1;
  // The solid part of an end cell lies at that end. That of a single cell lies at the lower end, but over the floor of the basin
  // at the upper one, because it is of a body that comes down on the floor.
  const bool is_gap = low == 0 && high == 1;
  if (!is_gap) span.floor += share(part(low));
  if (is_gap || high - 1 > low) span.roof -= share(part(high - 1));
  if (has_below(solid, column, low)) {
    const int open = SolidParts::FULL - part(low - 1);
    span.capacity += open * SolidParts::UNITS;
    span.floor -= share(open);
  }
  if (has_above(solid, column, high)) {
    const int open = SolidParts::FULL - part(high);
    span.capacity += open * SolidParts::UNITS;
    span.roof += share(open);
  }
  return span;
}

constexpr int MOST = 5;                   // cells that a plate tilted by 45 degrees passes through
constexpr double THINNEST = 7.0 / 8.0;    // part of a cell, the least that such a plate holds

bool holds_plate(const SolidParts &solid, int column, int from, int to)
{
  int sum = 0;
  for (int z = std::max(0, from); z < std::min(solid.nz, to); ++z) sum += solid.at(column, z);
  return share(sum) >= THINNEST;
}

bool goes_on(const SolidParts &solid, int column, int from, int to)
{
  for (int side = 0; side < 4; ++side)
    if (const int other = neighbour(column, side, solid.nx, solid.ny); other >= 0 && !holds_plate(solid, other, from, to))
      return false;
  return true;
}

// Whether there is no opening from one column to another between two heights.
bool is_closed(const SolidParts &solid, int column, int other, int from, int to)
{
  for (int z = std::max(0, from); z < std::min(solid.nz, to); ++z)
    if (solid.open_between(column, other, z) > 0) return false;
  return true;
}

// Whether partly solid cells [low, high) between open ones, with slivers in these, are a plate that lies across the column: one
// lattice cell thick, which may be a tenth thinner than a cell, and as thick in all columns beside it, perhaps a cell higher or
// lower. At the rim of a body there is less on one side.
bool is_plate(const SolidParts &solid, int column, int low, int high)
{ return high - low <= MOST && holds_plate(solid, column, low - 1, high + 1) && goes_on(solid, column, low - 2, high + 2); }

// The face in such a plate that has nearest to half of it below.
int middle_of(const SolidParts &solid, int column, int low, int high)
{
  int all = 0, below = 0, face = low + 1;
  for (int z = low; z < high; ++z) all += solid.at(column, z);
  for (int z = low, best = all; z + 1 < high; ++z) {
    below += solid.at(column, z);
    if (const int off = std::abs(all - 2 * below); off < best) best = off, face = z + 1;
  }
  return face;
}

// The same for some cells [low, high) of a column that an upright wall fills in part, above or below the plate or on both sides:
// the plate takes the same fraction of the space that the wall leaves open. Returns the face in its middle, or 0 where there is
// none.
int plate_at_wall(const SolidParts &solid, int column, int low, int high)
{
  const auto part = [&](int z) { return share(solid.at(column, z)); };
  const double below = part(low - 1), above = part(high);
  const auto under = [&](int z) { return (part(z) - below) / (1.0 - below); };
  const auto over = [&](int z) { return (part(z) - above) / (1.0 - above); };
  double sum = 0.0;
  for (int z = low; z < high; ++z) sum += over(z);
  double best = sum;
  int first_over = low;    // from here on there is the wall above
  for (int z = low; z + 1 < high; ++z) {
    sum += under(z) - over(z);
    if (sum > best) best = sum, first_over = z + 1;
  }
  if (best < THINNEST) return 0;
  for (int side = 0; side < 4; ++side) {
    const int other = neighbour(column, side, solid.nx, solid.ny);
    if (other < 0 || holds_plate(solid, other, low - 2, high + 2)) continue;
    if (!is_closed(solid, column, other, high - 1, high + 2) && !is_closed(solid, column, other, low - 2, low + 1)) return 0;
  }
  double half = 0.0, nearest = best;
  int face = low + 1;
  for (int z = low; z + 1 < high; ++z) {
    half += z < first_over ? under(z) : over(z);
    if (const double off = std::fabs(best - 2.0 * half); off < nearest) nearest = off, face = z + 1;
  }
  return face;
}

void cut_at_plates(const SolidParts &solid, const SolidParts &held, int column, int low, int high, std::vector<Span> &spans)
{
  const auto part = [&](int z) { return solid.at(column, z); };
  int from = low;
  const auto cut_at = [&](int face) {
    spans.push_back(cut(solid, column, from, face));
    from = face;
  };
  for (int z = low, end = low; z < high; z = end) {
    end = z + 1;
    if (part(z) < SolidParts::SLIVER) continue;
    while (end < high && part(end) >= SolidParts::SLIVER) ++end;
    if (z > low && end < high && is_plate(solid, column, z, end)) {
      cut_at(middle_of(solid, column, z, end));
      continue;
    }
    for (int first = std::max(z, low + 1); first < end; ++first)
      for (int cells = 2; cells <= MOST && first + cells < high; ++cells)
        if (const int face = plate_at_wall(held, column, first, first + cells); face > 0) {
          cut_at(face);
          first += cells - 1;
          break;
        }
  }
  spans.push_back(cut(solid, column, from, high));
}

}    // namespace

void cut_column(const SolidParts &solid, const SolidParts &held, int column, std::vector<Span> &spans)
{
  for (int z = 0; z < solid.nz;) {
    const int low = z;
    while (!solid.shut(column, z)) ++z;
    if (z > low)
      cut_at_plates(solid, held, column, low, z, spans);
    else
      ++z;
  }
}

Head head_of(const SolidParts &solid, const Span &span, Units content)
{
  if (content >= span.capacity) return {span.roof, 1.0};
  double left = static_cast<double>(content) / UNITS_PER_CELL;
  if (span.plain) return {span.floor + left, 1.0};
  for (int z = span.low; z < span.high; ++z) {
    const Slice s = slice(solid, span, z);
    if (s.open <= 0.0) continue;
    const double slope = s.open / (s.high - s.low);
    if (left < s.open) return {s.low + left / slope, slope};
    left -= s.open;
  }
  return {span.roof, 1.0};
}

double volume_below(const SolidParts &solid, const Span &span, double height)
{
  if (span.plain) return std::clamp(height - span.floor, 0.0, span.roof - span.floor);
  double volume = 0.0;
  for (int z = span.low; z < span.high; ++z) {
    const Slice s = slice(solid, span, z);
    volume += s.open * std::clamp((height - s.low) / (s.high - s.low), 0.0, 1.0);
  }
  return volume;
}

double moment_of(const SolidParts &solid, const Span &span, Units content)
{
  double left = static_cast<double>(std::min(content, span.capacity)) / UNITS_PER_CELL;
  if (span.plain) return left * (span.floor + 0.5 * left);
  double moment = 0.0;
  for (int z = span.low; z < span.high && left > 0.0; ++z) {
    const Slice s = slice(solid, span, z);
    if (s.open <= 0.0) continue;
    const double taken = std::min(left, s.open);
    moment += taken * (s.low + 0.5 * taken / s.open * (s.high - s.low));
    left -= taken;
  }
  return moment;
}

// At equal height the plate leaves less than half open. Spread samples of a tilted plate leave more than nothing.
bool are_parted(const SolidParts &solid, const Span &a, const Span &b)
{
  const auto is_below = [&](const Span &lower, const Span &upper) {
    const bool is_cut = !solid.shut(lower.column, lower.high) || !solid.shut(upper.column, upper.low - 1);
    if (!is_cut || lower.high == solid.nz || upper.low == 0) return false;
    for (int z = upper.low; z < lower.high; ++z)
      if (solid.at(lower.column, z) + solid.at(upper.column, z) < SolidParts::FULL / 2) return false;
    return true;
  };
  return is_below(a, b) || is_below(b, a);
}

double open_below(const SolidParts &solid, const Span &a, const Span &b, double height)
{
  const double below_top = std::min({height, static_cast<double>(a.high), static_cast<double>(b.high)});
  int z = std::max(a.low, b.low);
  double open = 0.0;
  const auto add = [&] {
    const double low = std::max({static_cast<double>(z), a.floor, b.floor});
    open += share(solid.open_between(a.column, b.column, z)) * std::clamp((height - low) / (z + 1.0 - low), 0.0, 1.0);
    ++z;
  };
  if (z < below_top) add();
  const int clear = std::min({a.clear, b.clear, static_cast<int>(below_top)});
  if (clear > z) {
    open += clear - z;
    z = clear;
  }
  while (z < below_top) add();
  return open;
}

}    // namespace mdanim
