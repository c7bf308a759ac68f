// SPDX-License-Identifier: GPL-2.0-only
// One update, step by step: rows by the kernels, then what is listed by the general form.

#include "liquid/waves.h"

#include <algorithm>
#include <cmath>

namespace mdanim {

void Waves::update(double dt)
{
  constexpr double FARTHEST = 0.5;    // cells that liquid goes in a sub-update
  if (resting) return;
  ++counts.updates;
  const int parts = std::max(1, static_cast<int>(std::ceil(fastest() * dt / FARTHEST)));
  for (int n = 0; n < parts; ++n) sub_update(dt / parts, 1.0 / parts);
  std::fill_n(arrays.coming, content.size(), 0.0);
  if (hardly_flows()) come_to_rest();
}

// By velocities in open liquid, by fluxes in thin layers: a puddle that passes less than half a unit keeps its velocity for ever.
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
  double most = kernels->fastest(arrays, 1, end_row());
  for (int d = 0; d < 2; ++d)
    for (std::size_t n = 0; n < further_links[d].size(); ++n)
      most = std::max(most, std::fabs(arrays.links[d].u[links_start + n]));
  return most;
}

void Waves::sub_update(double dt, double share)
{
  const long end = end_row();
  ++counts.sub_updates;
  law.dt = dt;
  law.share = share;

  const bool were_full = some_full;
  some_full = kernels->surfaces(arrays, law, 1, end);
  for (const long i : listed_spans) {
    general_surface(i);
    some_full = some_full || arrays.full[i] > 0.0;
  }
  for (int d = 0; d < 2; ++d) kernels->open_links(arrays, law, d, 1, end);
  for (const LinkPlace &link : listed_links) general_opening(link);
  for (int d = 0; d < 2; ++d) kernels->advect(arrays, law, d, 1, end);
  for (const LinkPlace &link : listed_links) general_advection(link);

  constexpr int MOST_PASSES = 4;
  for (int pass = 0; pass < MOST_PASSES; ++pass) {
    kernels->assemble(arrays, law, some_full || were_full, 1, end);
    for (const long i : listed_spans) general_assembly(i);
    kernels->couple(arrays, 1, end);
    for (const LinkPlace &link : listed_links) general_coupling(link);
    solve(pass > 0);
    if (!some_full || !let_go()) break;
    if (pass == MOST_PASSES - 1) kernels->guess(arrays, true, 1, end);
  }
  kernels->heads(arrays, law, 1, end);

  for (int d = 0; d < 2; ++d) kernels->push(arrays, law, d, 1, end);
  for (const LinkPlace &link : listed_links) general_push(link);
  bool fits = kernels->balance(arrays, law, 1, end);
  const auto balance = [&](long i) {
    const SpanFluxes<double> fluxes = fluxes_of(i);
    const double units = static_cast<double>(content[i]), most = (arrays.capacity[i] + 0.25) * law.units_per_cell;
    arrays.net[i] = fluxes.in - fluxes.out;
    fits = fits && fluxes.out_share(units) == 1.0 && fluxes.in_share(units, most) == 1.0;
  };
  for (const long i : listed_spans) balance(i);
  if (!fits) {
    limit();
    kernels->balance(arrays, law, 1, end);
    for (const long i : listed_spans) balance(i);
  }
  kernels->settle(arrays, law, 1, end);
  for (int d = 0; d < 2; ++d)
    for (std::size_t n = 0; n < further_links[d].size(); ++n)
      arrays.links[d].q[links_start + n] = arrays.links[d].units[links_start + n] * (1.0 / (law.units_per_cell * law.dt));
}

// Nothing pulls at a roof: full spans whose head comes out below it are free. Returns whether there are any; then what was found
// for all heads is in p.
bool Waves::let_go()
{
  constexpr double ROUNDING = 1e-6;
  bool any = false;
  for (long i = stride; i < end_row() * stride; ++i) {
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
