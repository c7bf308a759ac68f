// SPDX-License-Identifier: GPL-2.0-only
// The steps of an update for one span or link of any kind; kernels do the same where everything is regular.

#include "liquid/waves/wave_stepper.h"
#include "liquid/waves/waves_link_steps.h"

#include <cmath>

namespace mdanim {

void WaveStepper::general_surface(long i)
{
  const Head free_head = head_of(columns.solid, span[i], content[i]);
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

void WaveStepper::general_opening(const LinkPlace &link)
{
  const Ends e = columns.ends(link);
  open_at<double>(arrays, law, {columns.arrays_of(link), link.d, link.at, e.a, e.b},
                  [&](double level) { return columns.opening(link, level); });
}

// Fluxes and heights of a side are summed; its velocity is that of the link with the largest.
WaveStepper::SideLinks WaveStepper::side_of(long i, SideOf side) const
{
  const int d = side == WEST || side == EAST ? 0 : 1;
  const bool inward = side == WEST || side == SOUTH;
  SideLinks sum{0.0, 0.0, 0.0, -1};
  double most = -1.0, widest = 0.0;
  const auto add = [&](const LinkPlace &link, long other) {
    const WaveLinks &l = columns.arrays_of(link);
    const long j = link.at;
    if (!columns.is_link(link)) return;
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
  add({d, inward ? i - columns.along(d) : i}, inward ? i - columns.along(d) : i + columns.along(d));
  columns.each_further_link_of(i, [&](const LinkPlace &link, long other, bool comes_in) {
    if (link.d == d && comes_in == inward) add(link, other);
  });
  return sum;
}

void WaveStepper::general_advection(const LinkPlace &link)
{
  const WaveLinks &l = columns.arrays_of(link);
  const Ends e = columns.ends(link);
  const long j = link.at;
  l.faster[j] = l.rubbed[j] = 0.0;
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
  const auto found = advected(law, l.u[j], around, arrays.volume[e.a], arrays.volume[e.b], l.height[j]);
  l.faster[j] = l.more[j] > 0.0 ? l.u[j] + (found.u - l.u[j]) * columns.ease(link) : found.u;
  l.rubbed[j] = found.rubbed;
}

void WaveStepper::general_push(const LinkPlace &link)
{
  const Ends e = columns.ends(link);
  push_at<double>(
      arrays, law, {columns.arrays_of(link), link.d, link.at, e.a, e.b},
      [&](double level) { return columns.opening(link, level); }, columns.ease(link));
}

SpanFluxes<double> WaveStepper::fluxes_of(long i) const
{
  SpanFluxes<double> fluxes;
  columns.each_link_of(i, [&](const LinkPlace &link, long, bool inward) {
    const double units = columns.arrays_of(link).units[link.at];
    fluxes.add(inward ? units : 0.0 - units);
  });
  return fluxes;
}

}    // namespace mdanim
