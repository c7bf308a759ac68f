// SPDX-License-Identifier: GPL-2.0-only
// Mouths of ducts under held roofs, and the inertia of the liquid that turns up or down there.

#include "liquid/waves/wave_mouths.h"

#include "liquid/waves/columns.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

namespace {

struct Parts {
  std::vector<int> of;    // the part that each column belongs to, or -1
  int count;
};

// Parts of columns that hang together.
template <class Among, class Joined> Parts parts_of(int nx, int ny, const Among &among, const Joined &joined)
{
  Parts parts{std::vector<int>(nx * ny, -1), 0};
  std::vector<int> left;
  for (int first = 0; first < nx * ny; ++first) {
    if (parts.of[first] >= 0 || !among(first)) continue;
    parts.of[first] = parts.count;
    left.assign(1, first);
    while (!left.empty()) {
      const int column = left.back();
      left.pop_back();
      for (int side = 0; side < 4; ++side) {
        const int other = neighbour(column, side, nx, ny);
        if (other < 0 || parts.of[other] >= 0 || !among(other) || !joined(column, other)) continue;
        parts.of[other] = parts.count;
        left.push_back(other);
      }
    }
    ++parts.count;
  }
  return parts;
}

}    // namespace

// By what is held alone: arms are open to the top of the basin, and ducts have roofs and join two arms or more.
void WaveMouths::list()
{
  const int nx = columns.nx, ny = columns.ny, nz = columns.nz;
  std::vector<std::vector<Span>> cut(nx * ny);
  for (int column = 0; column < nx * ny; ++column) cut_column(columns.wall, columns.wall, column, cut[column]);
  const auto is_open = [&](int column) { return !cut[column].empty() && cut[column].back().high == nz; };
  const auto meet = [&](const Span &a, const Span &b) { return a.overlaps(b) && !are_parted(columns.wall, a, b); };
  const Parts arms =
      parts_of(nx, ny, is_open, [&](int column, int other) { return meet(cut[column].back(), cut[other].back()); });
  const Parts ducts = parts_of(
      nx, ny, [&](int column) { return !cut[column].empty() && !is_open(column); },
      [&](int column, int other) {
        return std::any_of(cut[column].begin(), cut[column].end(), [&](const Span &a) {
          return std::any_of(cut[other].begin(), cut[other].end(), [&](const Span &b) { return meet(a, b); });
        });
      });

  mouths.clear();
  std::vector<int> arm_at(ducts.count, -1), columns_of(arms.count, 0), mouths_of(arms.count, 0);
  std::vector<std::uint8_t> joins(ducts.count, 0);
  for (int column = 0; column < nx * ny; ++column) {
    if (arms.of[column] < 0) continue;
    ++columns_of[arms.of[column]];
    for (int side = 0; side < 4; ++side) {
      const int other = neighbour(column, side, nx, ny);
      if (other < 0 || ducts.of[other] < 0) continue;
      const Span &arm = cut[column].back();
      const bool arm_is_first = side == EAST || side == NORTH;
      double next = WaveArrays::NOWHERE;
      for (auto duct = cut[other].rbegin(); duct != cut[other].rend(); ++duct) {
        if (!meet(arm, *duct)) continue;
        const WaveColumns::LinkPlace nowhere{side == WEST || side == EAST ? 0 : 1, -1};
        mouths.push_back({nowhere, column, other, arm_is_first, duct->roof, next});
        next = std::max(arm.floor, duct->floor);
        int &first = arm_at[ducts.of[other]];
        joins[ducts.of[other]] |= first >= 0 && first != arms.of[column];
        first = arms.of[column];
      }
    }
  }
  mouths.erase(std::remove_if(mouths.begin(), mouths.end(), [&](const DuctMouth &mouth) { return !joins[ducts.of[mouth.duct]]; }),
               mouths.end());
  std::fill(columns.general.begin(), columns.general.end(), 0);
  for (const DuctMouth &mouth : mouths) {
    ++mouths_of[arms.of[mouth.arm]];
    columns.general[mouth.arm] = columns.general[mouth.duct] = 1;
  }
  for (int column = 0; column < nx * ny; ++column) {
    const int arm = arms.of[column], many = arm < 0 ? 0 : mouths_of[arm];
    arm_wide[column] = many == 0 ? WaveArrays::NOWHERE : static_cast<double>(columns_of[arm]) / many;
    if (arm_wide[column] < nz) columns.general[column] = 1;
  }
}

void WaveMouths::find_links()
{
  constexpr double SAME = 1e-9;
  for (DuctMouth &mouth : mouths) {
    const int d = mouth.link.d;
    mouth.link.at = -1;
    const auto look = [&](const WaveColumns::LinkPlace &link) {
      const WaveColumns::Ends e = columns.ends(link);
      const Span &arm = columns.span[mouth.arm_is_first ? e.a : e.b], &duct = columns.span[mouth.arm_is_first ? e.b : e.a];
      if (arm.column == mouth.arm && duct.column == mouth.duct && arm.high == columns.nz &&
          std::fabs(duct.roof - mouth.roof) < SAME)
        mouth.link.at = link.at;
    };
    const WaveColumns::LinkPlace lowest{d, columns.place(mouth.arm_is_first ? mouth.arm : mouth.duct)};
    if (columns.is_link(lowest)) look(lowest);
    columns.further_links_of(d, look);
  }
}

// Liquid that fills an arm to above the roof of the duct. As it rises the same energy moves more of it, and the flow is slower.
void WaveMouths::load(const WaveLaw &law)
{
  for (DuctMouth &mouth : mouths) {
    if (mouth.link.at < 0) continue;
    const WaveLinks &l = columns.arrays_of(mouth.link);
    const long j = mouth.link.at;
    mouth.u = l.u[j];
    const WaveColumns::Ends e = columns.ends(mouth.link);
    const long arm = mouth.arm_is_first ? e.a : e.b;
    const double open = l.height[j], head = columns.arrays.head[arm], above = head - mouth.roof, wide = arm_wide[mouth.arm];
    l.more[j] = 0.0;
    if (!(open > law.film) || above <= 0.0 || columns.arrays.full[arm] > 0.0 || head > mouth.next) continue;
    const auto inertia = [&](double height) { return mouth_inertia(height, open, wide, in_narrow_arm(arm)); };
    l.more[j] = inertia(above);
    const double rise = (mouth.arm_is_first ? -1.0 : 1.0) * open * l.u[j] / wide * law.dt;
    l.u[j] *= root((1.0 + l.more[j]) / (1.0 + inertia(std::max(0.0, above + rise))));
  }
}

Vec3 WaveMouths::turned() const
{
  double sum[2] = {0.0, 0.0};
  for (const DuctMouth &mouth : mouths) {
    if (mouth.link.at < 0) continue;
    const WaveLinks &l = columns.arrays_of(mouth.link);
    const long j = mouth.link.at;
    sum[mouth.link.d] += l.more[j] * l.height[j] * (l.u[j] - mouth.u);
  }
  return {sum[0], sum[1], 0.0};
}

}    // namespace mdanim
