// SPDX-License-Identifier: GPL-2.0-only
// One update, step by step: rows by the kernels, then listed spans and links by the general form.

#include "liquid/waves/waves.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

double Waves::update(double dt, double share)
{
  constexpr double FARTHEST = 0.5;    // cells that liquid goes in a sub-update
  if (resting) return dt;
  ++counts.updates;
  const int parts = std::max(1, static_cast<int>(std::ceil(fastest() * dt / FARTHEST)));
  double gone = 0.0;
  for (int n = 0; n < parts; ++n) {
    sub_update(dt / parts, share / parts);
    gone += law.dt;
  }
  for (std::size_t i = 0; i < content.size(); ++i) arrays.coming[i] = share < 1.0 ? (1.0 - share) * arrays.coming[i] : 0.0;
  if (hardly_flows()) come_to_rest();
  return gone;
}

// Judged by velocities in open liquid, by fluxes in thin layers: a puddle that passes less than half a unit keeps its velocity
// for ever.
bool Waves::hardly_flows() const
{
  constexpr double IN_PUDDLES = 0.1;
  if (fastest() > IN_PUDDLES) return false;
  bool hardly = true;
  each_link([&](const LinkPlace &link) {
    const WaveLinks &l = arrays_of(link);
    hardly = hardly && std::fabs(l.u[link.at]) * std::min(1.0, l.height[link.at]) < rest;
  });
  return hardly;
}

double Waves::fastest() const
{
  std::atomic<double> most_of_rows{0.0};
  rows([&](long first, long end) {
    const double of_part = kernels->fastest(arrays, first, end);
    for (double known = most_of_rows; of_part > known && !most_of_rows.compare_exchange_weak(known, of_part);) {}
  });
  double most = most_of_rows;
  for (int d = 0; d < 2; ++d)
    for (std::size_t n = 0; n < further_links[d].size(); ++n)
      most = std::max(most, std::fabs(arrays.links[d].u[links_start + n]));
  return most;
}

void Waves::sub_update(double dt, double share)
{
  ++counts.sub_updates;
  law.dt = dt;
  law.share = share;

  const bool were_full = some_full;
  some_full = any_row([&](long first, long end) { return kernels->surfaces(arrays, law, first, end); });
  each_listed(listed_spans, [&](long i) { general_surface(i); });
  for (const long i : listed_spans) some_full = some_full || arrays.full[i] > 0.0;
  rows([&](long first, long end) {
    for (int d = 0; d < 2; ++d) kernels->open_links(arrays, law, d, first, end);
  });
  each_listed(listed_links, [&](const LinkPlace &link) { general_opening(link); });
  rows([&](long first, long end) {
    for (int d = 0; d < 2; ++d) kernels->advect(arrays, law, d, first, end);
  });
  each_listed(listed_links, [&](const LinkPlace &link) { general_advection(link); });

  constexpr int MOST_PASSES = 4;
  for (int pass = 0; pass < MOST_PASSES; ++pass) {
    rows([&](long first, long end) { kernels->assemble(arrays, law, some_full || were_full, first, end); });
    each_listed(listed_spans, [&](long i) { general_assembly(i); });
    rows([&](long first, long end) { kernels->couple(arrays, first, end); });
    each_listed(listed_links, [&](const LinkPlace &link) { general_coupling(link); });
    solve(pass > 0);
    if (!some_full || !let_go()) break;
    if (pass == MOST_PASSES - 1) rows([&](long first, long end) { kernels->guess(arrays, true, first, end); });
  }
  rows([&](long first, long end) { kernels->heads(arrays, law, first, end); });

  rows([&](long first, long end) {
    for (int d = 0; d < 2; ++d) kernels->push(arrays, law, d, first, end);
  });
  each_listed(listed_links, [&](const LinkPlace &link) { general_push(link); });
  lost += law.dt * (force_on_walls() + law.calm * moving());
  if (const RowRange tight = balance(); tight.first < tight.last) {
    limit(tight);
    balance();
  }
  rows([&](long first, long end) { kernels->settle(arrays, law, first, end); });
  for (int d = 0; d < 2; ++d)
    for (std::size_t n = 0; n < further_links[d].size(); ++n)
      arrays.links[d].q[links_start + n] = arrays.links[d].units[links_start + n] * (1.0 / (law.units_per_cell * law.dt));
}

// Momentum along x and y before pressure, after friction has taken a part of it.
Vec3 Waves::moving() const
{
  double sum[2] = {0.0, 0.0};
  for (int d = 0; d < 2; ++d) {
    const WaveLinks &l = arrays.links[d];
    for (long row = 1; row < end_row(); ++row) sum[d] += l.moving[row];
    for (std::size_t n = 0; n < further_links[d].size(); ++n) sum[d] += l.height[links_start + n] * l.faster[links_start + n];
  }
  return {sum[0], sum[1], 0.0};
}

// A roof cannot pull: full spans whose head comes out below it become free. Returns whether there are any; then the heads found
// so far are in p.
bool Waves::let_go()
{
  return any_row([this](long first, long end) { return let_go(first, end); });
}

bool Waves::let_go(long first, long end)
{
  constexpr double ROUNDING = 1e-6;
  bool any = false;
  for (long i = first * stride; i < end * stride; ++i) {
    arrays.p[i] = arrays.scale[i] * arrays.x[i];
    if (arrays.full[i] == 0.0 || arrays.head[i] + arrays.p[i] >= arrays.roof[i] - ROUNDING) continue;
    const Head head = head_of(solid, span[i], content[i]);
    arrays.full[i] = 0.0;
    arrays.p[i] += arrays.head[i] - head.height;
    arrays.head[i] = head.height;
    arrays.slope[i] = head.slope;
    any = true;
  }
  return any;
}

}    // namespace mdanim
