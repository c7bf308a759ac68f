// SPDX-License-Identifier: GPL-2.0-only
// The liquid as a whole.

#include "liquid/waves/waves.h"

#include "simd/kernels.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

Waves::Waves(int nx, int ny, int nz)
    : columns(nx, ny, nz), exchange(columns, run), cut(columns, run), walls(columns), mouths(columns),
      stepper(columns, run, walls, mouths)
{
  run.kernels = &widest_kernels().waves;
  run.law.height = nz;
  run.law.fastest = 4.0 * std::sqrt(run.law.height);
}

double Waves::update(double dt, double share)
{
  if (run.resting) return dt;
  const double gone = stepper.update(dt, share);
  if (!run.is_moved && stepper.hardly_flows()) cut.come_to_rest();
  return gone;
}

void Waves::pour(const double *height, const double *from, const std::vector<std::uint8_t> &hollow)
{
  run.resting = false;
  columns.each_span([&](long i) {
    const double level = !hollow.empty() && hollow[i] ? 0.0 : height[columns.span[i].column];
    const auto up_to = [&](double z) {    // not a unit less than its capacity
      return z >= columns.span[i].roof ? columns.span[i].capacity
                                       : static_cast<Units>(volume_below(columns.solid, columns.span[i], z) * UNITS_PER_CELL);
    };
    columns.content[i] = up_to(level) - (from ? up_to(std::min(level, from[columns.span[i].column])) : 0);
    const Head head = head_of(columns.solid, columns.span[i], columns.content[i]);
    const bool full = columns.content[i] >= columns.span[i].capacity;
    columns.arrays.full[i] = full ? 1.0 : 0.0;
    columns.arrays.rest[i] = columns.arrays.phi[i] = columns.arrays.head[i] =
        full ? std::max(columns.span[i].roof, level) : head.height;
    columns.arrays.delta[i] = columns.arrays.last_delta[i] = 0.0;
    columns.arrays.coming[i] = 0.0;    // solids were there before
  });
}

Units Waves::total() const
{
  Units sum = 0;
  for (const Units units : columns.content) sum += units;
  return sum;
}

Waves::Energy Waves::energy() const
{
  Energy energy{};
  columns.each_span([&](long i) {
    const Span &span = columns.span[i];
    const double excess = static_cast<double>(std::max<Units>(0, columns.content[i] - span.capacity)) / UNITS_PER_CELL;
    energy.height += moment_of(columns.solid, span, columns.content[i]) + excess * span.roof;
  });
  columns.each_link([&](const LinkPlace &link) {
    const WaveLinks &l = columns.arrays_of(link);
    energy.motion += 0.5 * l.height[link.at] * (1.0 + l.more[link.at]) * l.u[link.at] * l.u[link.at];
  });
  return energy;
}

Vec3 Waves::momentum() const
{
  Vec3 sum;
  columns.each_link([&](const LinkPlace &link) {
    const WaveLinks &l = columns.arrays_of(link);
    (link.d == 0 ? sum.x : sum.y) += l.height[link.at] * l.u[link.at];
  });
  return sum;
}

}    // namespace mdanim
