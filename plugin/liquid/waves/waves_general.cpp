// SPDX-License-Identifier: GPL-2.0-only
// The steps of an update for one span or link of any kind; kernels do the same where everything is regular.

#include "liquid/waves/waves.h"
#include "liquid/waves/waves_link_steps.h"

#include <cmath>

namespace mdanim {

double Waves::opening(const LinkPlace &link, double level) const
{
  const WaveLinks &l = arrays_of(link);
  if (!is_layered(link)) return smaller(level, l.top[link.at]) - l.edge[link.at];
  const Ends e = ends(link);
  return open_below(solid, span[e.a], span[e.b], level);
}

void Waves::general_surface(long i)
{
  const Head free_head = head_of(solid, span[i], content[i]);
  const double volume = static_cast<double>(content[i]) / UNITS_PER_CELL;
  // A span that the kernel has just made full or free is so by its content alone, which is repeated here.
  const auto s = ::mdanim::surface(volume, arrays.capacity[i], span[i].roof, free_head.height, arrays.full[i], arrays.rest[i],
                                   arrays.phi[i]);
  arrays.volume[i] = volume;
  arrays.full[i] = s.full;
  arrays.rest[i] = s.rest;
  arrays.phi[i] = s.phi;
  arrays.head[i] = s.head;
  arrays.slope[i] = free_head.slope;
}

void Waves::general_opening(const LinkPlace &link)
{
  const Ends e = ends(link);
  open_at<double>(arrays, law, {arrays_of(link), link.at, e.a, e.b}, [&](double level) { return opening(link, level); });
}

// Fluxes and heights of a side are summed; its velocity is that of the link with the largest.
Waves::SideLinks Waves::side_of(long i, SideOf side) const
{
  const int d = side == WEST || side == EAST ? 0 : 1;
  const bool inward = side == WEST || side == SOUTH;
  SideLinks sum{0.0, 0.0, 0.0, -1};
  double most = -1.0, widest = 0.0;
  const auto add = [&](const LinkPlace &link, long other) {
    const WaveLinks &l = arrays_of(link);
    const long j = link.at;
    if (!is_link(link)) return;
    if (l.top[j] - l.edge[j] > widest) {
      widest = l.top[j] - l.edge[j];
      sum.widest = other;
    }
    if (l.wet[j] == 0.0) return;
    sum.q += l.q[j];
    if (std::fabs(l.q[j]) > most) {
      most = std::fabs(l.q[j]);
      sum.u = l.u[j];
    }
    sum.height += l.height[j];
  };
  add({d, inward ? i - along(d) : i}, inward ? i - along(d) : i + along(d));
  for (int n = chain[i]; n >= 0; n = link_of_span[n].next)
    if (link_of_span[n].link.d == d && link_of_span[n].inward == inward) add(link_of_span[n].link, link_of_span[n].other);
  return sum;
}

void Waves::general_advection(const LinkPlace &link)
{
  const WaveLinks &l = arrays_of(link);
  const Ends e = ends(link);
  const long j = link.at;
  l.faster[j] = 0.0;
  if (l.wet[j] == 0.0) return;
  const SideOf back = link.d == 0 ? WEST : SOUTH, ahead = link.d == 0 ? EAST : NORTH;
  const SideOf left = link.d == 0 ? SOUTH : WEST, right = link.d == 0 ? NORTH : EAST;
  Around<double> around;
  const auto set = [&](int n, const SideLinks &side, double inflow) {
    around.u[n] = side.u;
    around.height[n] = side.height;
    around.inflow[n] = inflow;
  };
  // The link beside this one: between the spans beside its own.
  const auto beside = [&](long of_a, long of_b) {
    SideLinks found{0.0, 0.0, 0.0, -1};
    if (of_a >= 0) found = side_of(of_a, ahead);
    if (found.height == 0.0 && of_b >= 0) found = side_of(of_b, back);
    return found;
  };
  const SideLinks behind = side_of(e.a, back), before = side_of(e.b, ahead);
  set(0, behind, 0.5 * (behind.q + l.q[j]));
  set(1, before, 0.0 - 0.5 * (l.q[j] + before.q));
  const SideLinks left_a = side_of(e.a, left), left_b = side_of(e.b, left);
  set(2, beside(left_a.widest, left_b.widest), 0.5 * (left_a.q + left_b.q));
  const SideLinks right_a = side_of(e.a, right), right_b = side_of(e.b, right);
  set(3, beside(right_a.widest, right_b.widest), 0.0 - 0.5 * (right_a.q + right_b.q));
  l.faster[j] = advected(law, l.u[j], around, arrays.volume[e.a], arrays.volume[e.b], l.height[j]);
}

void Waves::general_assembly(long i)
{
  const double head = arrays.head[i], full = arrays.full[i];
  SpanSums<double> sums;
  each_link_of(i, [&](const LinkPlace &link, long other, bool inward) {
    const WaveLinks &l = arrays_of(link);
    const double flux = l.height[link.at] * l.faster[link.at] * law.dt;
    sums.look(head, arrays.head[other], l.wet[link.at], full, arrays.full[other], inward ? flux : 0.0 - flux);
  });
  if (full > 0.0) {
    sums.diagonal = arrays.yields[i] * (1.0 / (law.share * law.share));
    sums.rhs = full_rhs(law, arrays.volume[i], arrays.capacity[i], arrays.coming[i], sums.inflow);
  } else {
    sums.diagonal = free_stiffness(law, sums.steepest, arrays.volume[i], arrays.slope[i]);
    // A partly solid column has the head that it will have: otherwise liquid under nearly shut cells would rise and fall for
    // ever.
    if (arrays.slope[i] < POROUS) sums.rhs = sums.inflow / (law.dt * law.dt);
  }
  arrays.beside_full[i] = sums.beside_full;
  each_link_of(i, [&](const LinkPlace &link, long other, bool) {
    const WaveLinks &l = arrays_of(link);
    sums.couple(head, arrays.head[other], l.edge[link.at], l.height[link.at]);
  });
  const bool solved = sums.diagonal > 0.0;
  arrays.scale[i] = 1.0 / root(solved ? sums.diagonal : 1.0);
  arrays.rhs[i] = solved ? sums.rhs * arrays.scale[i] : 0.0;
}

void Waves::general_coupling(const LinkPlace &link)
{
  const WaveLinks &l = arrays_of(link);
  const Ends e = ends(link);
  const double bare = coupling(arrays.head[e.a], arrays.head[e.b], l.edge[link.at], l.height[link.at]);
  l.couple[link.at] = bare * arrays.scale[e.a] * arrays.scale[e.b];
}

double Waves::general_product(long i, const double *x) const
{
  double sum = x[i];
  each_link_of(i, [&](const LinkPlace &link, long other, bool) { sum -= arrays_of(link).couple[link.at] * x[other]; });
  return sum;
}

void Waves::general_push(const LinkPlace &link)
{
  const Ends e = ends(link);
  push_at<double>(arrays, law, {arrays_of(link), link.at, e.a, e.b}, [&](double level) { return opening(link, level); });
}

SpanFluxes<double> Waves::fluxes_of(long i) const
{
  SpanFluxes<double> fluxes;
  each_link_of(i, [&](const LinkPlace &link, long, bool inward) {
    const double units = arrays_of(link).units[link.at];
    fluxes.add(inward ? units : 0.0 - units);
  });
  return fluxes;
}

}    // namespace mdanim
