// SPDX-License-Identifier: GPL-2.0-only

#include "liquid/span.h"

#include <algorithm>

namespace mdanim {

namespace {

double share(int part) { return part / static_cast<double>(SolidParts::FULL); }

// Whether a span that ends below a shut cell has what is open of it. Of one between two spans the upper one has it.
bool has_shut_roof(const SolidParts &solid, int column, int high) { return high < solid.nz && solid.shut(column, high + 1); }

// The open part of a cell of a span, and between which heights the cell takes liquid in.
struct Slice {
  double low, high, open;
};

Slice slice(const SolidParts &solid, const Span &span, int z)
{
  Slice s{static_cast<double>(z), z + 1.0, share(SolidParts::FULL - solid.at(span.column, z))};
  if (z == span.low) {
    s.low = span.floor;
    if (z > 0) s.open += share(SolidParts::FULL - solid.at(span.column, z - 1));
  }
  if (z == span.high - 1) {
    s.high = span.roof;
    if (has_shut_roof(solid, span.column, span.high)) s.open += share(SolidParts::FULL - solid.at(span.column, span.high));
  }
  return s;
}

Span cut(const SolidParts &solid, int column, int low, int high)
{
  Span span{column, low, high, true, static_cast<double>(low), static_cast<double>(high), 0};
  const auto part = [&](int z) { return solid.at(column, z); };
  for (int z = low; z < high; ++z) {
    span.capacity += (SolidParts::FULL - part(z)) * SolidParts::UNITS;
    if (z > low && z < high - 1 && part(z)) span.plain = false;
  }
  // The solid part of an end cell lies at that end.
  span.floor += share(part(low));
  if (high - 1 > low) span.roof -= share(part(high - 1));
  if (low > 0) {
    const int open = SolidParts::FULL - part(low - 1);
    span.capacity += open * SolidParts::UNITS;
    span.floor -= share(open);
  }
  if (has_shut_roof(solid, column, high)) {
    const int open = SolidParts::FULL - part(high);
    span.capacity += open * SolidParts::UNITS;
    span.roof += share(open);
  }
  return span;
}

}    // namespace

void cut_column(const SolidParts &solid, int column, std::vector<Span> &spans)
{
  for (int z = 0; z < solid.nz;) {
    const int low = z;
    while (!solid.shut(column, z)) ++z;
    if (z > low)
      spans.push_back(cut(solid, column, low, z));
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

double open_below(const SolidParts &solid, const Span &a, const Span &b, double height)
{
  double open = 0.0;
  const int top = std::min(a.high, b.high);
  for (int z = std::max(a.low, b.low); z < top && z < height; ++z) {
    const double low = std::max({static_cast<double>(z), a.floor, b.floor});
    open += share(solid.open_between(a.column, b.column, z)) * std::clamp((height - low) / (z + 1.0 - low), 0.0, 1.0);
  }
  return open;
}

}    // namespace mdanim
