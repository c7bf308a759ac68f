// SPDX-License-Identifier: GPL-2.0-only
// The order of the steps, and (W9): fluxes are scaled down, in whole units, where a span would give more than it has or take more
// than it can hold.

#include "liquid/waves/wave_stepper.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace mdanim {

double WaveStepper::update(double dt, double share)
{
  constexpr double FARTHEST = 0.5;    // cells that liquid goes in a sub-update
  ++run.counts.updates;
  const int parts = std::max(1, static_cast<int>(std::ceil(fastest() * dt / FARTHEST)));
  double gone = 0.0;
  for (int n = 0; n < parts; ++n) {
    sub_update(dt / parts, share / parts);
    gone += law.dt;
  }
  for (std::size_t i = 0; i < content.size(); ++i) arrays.coming[i] = share < 1.0 ? (1.0 - share) * arrays.coming[i] : 0.0;
  return gone;
}

// Judged by velocities in open liquid, by fluxes in thin layers: a puddle that passes less than half a unit keeps its velocity
// for ever.
bool WaveStepper::hardly_flows() const
{
  constexpr double IN_PUDDLES = 0.1;
  if (fastest() > IN_PUDDLES) return false;
  bool hardly = true;
  columns.each_link([&](const LinkPlace &link) {
    const WaveLinks &l = columns.arrays_of(link);
    hardly = hardly && std::fabs(l.u[link.at]) * std::min(1.0, l.height[link.at]) < run.rest;
  });
  return hardly;
}

double WaveStepper::fastest() const
{
  std::atomic<double> most_of_rows{0.0};
  loops.rows([&](long first, long end) {
    const double of_part = run.kernels->fastest(arrays, first, end);
    for (double known = most_of_rows; of_part > known && !most_of_rows.compare_exchange_weak(known, of_part);) {}
  });
  double most = most_of_rows;
  for (int d = 0; d < 2; ++d)
    columns.further_links_of(d, [&](const LinkPlace &link) { most = std::max(most, std::fabs(arrays.links[d].u[link.at])); });
  return most;
}

void WaveStepper::sub_update(double dt, double share)
{
  ++run.counts.sub_updates;
  law.dt = dt;
  law.share = share;

  const bool were_full = run.some_full;
  find_surfaces();
  solver.find_heads(were_full);
  move_links();
}

void WaveStepper::find_surfaces()
{
  run.some_full = loops.any_row([&](long first, long end) { return run.kernels->surfaces(arrays, law, first, end); });
  loops.each_listed(columns.listed_spans, [&](long i) { general_surface(i); });
  for (const long i : columns.listed_spans) run.some_full = run.some_full || arrays.full[i] > 0.0;
  loops.rows([&](long first, long end) {
    for (int d = 0; d < 2; ++d) run.kernels->open_links(arrays, law, d, first, end);
  });
  loops.each_listed(columns.listed_links, [&](const LinkPlace &link) { general_opening(link); });
  mouths.load(law);
  loops.rows([&](long first, long end) {
    for (int d = 0; d < 2; ++d) run.kernels->advect(arrays, law, d, first, end);
  });
  loops.each_listed(columns.listed_links, [&](const LinkPlace &link) { general_advection(link); });
}

void WaveStepper::move_links()
{
  loops.rows([&](long first, long end) {
    for (int d = 0; d < 2; ++d) run.kernels->push(arrays, law, d, first, end);
  });
  loops.each_listed(columns.listed_links, [&](const LinkPlace &link) { general_push(link); });
  run.lost += law.dt * (walls.force() + law.calm * momentum(&WaveLinks::moving, &WaveLinks::faster)) + mouths.turned();
  if (law.bed > 0.0) run.lost += momentum(&WaveLinks::rubbing, &WaveLinks::rubbed);
  if (run.is_moved) leave_behind();
  if (const WaveLoops::RowRange tight = balance(); tight.first < tight.last) {
    limit(tight);
    balance();
  }
  loops.rows([&](long first, long end) { run.kernels->settle(arrays, law, first, end); });
  for (int d = 0; d < 2; ++d)
    columns.further_links_of(d, [&](const LinkPlace &link) {
      arrays.links[d].q[link.at] = arrays.links[d].units[link.at] * (1.0 / (law.units_per_cell * law.dt));
    });
}

// Momentum along x and y by sums of rows of the grid, and by the velocities of further links.
Vec3 WaveStepper::momentum(double *WaveLinks::*of_rows, double *WaveLinks::*of_links) const
{
  double sum[2] = {0.0, 0.0};
  for (int d = 0; d < 2; ++d) {
    const WaveLinks &l = arrays.links[d];
    for (long row = 1; row < columns.end_row(); ++row) sum[d] += (l.*of_rows)[row];
    columns.further_links_of(d, [&](const LinkPlace &link) { sum[d] += l.height[link.at] * (l.*of_links)[link.at]; });
  }
  return {sum[0], sum[1], 0.0};
}

// Momentum along x and y that liquid has lost against a basin that gains speed, and the work: by the momentum that it had
// meanwhile, the mean of that before and after pressure.
void WaveStepper::leave_behind()
{
  double wet[2] = {0.0, 0.0}, momentum[2] = {0.0, 0.0};
  columns.each_link([&](const LinkPlace &link) {
    const WaveLinks &l = columns.arrays_of(link);
    const long i = link.at;
    if (!(l.wet[i] > 0.0)) return;
    wet[link.d] += l.height[i];
    momentum[link.d] += 0.5 * l.height[i] * (l.faster[i] + l.u[i]);
  });
  run.left_behind += law.dt * Vec3{law.tilt[0] * wet[0], law.tilt[1] * wet[1], 0.0};
  run.climbed += law.dt * (law.tilt[0] * momentum[0] + law.tilt[1] * momentum[1]);
}

// Sums the units into spans and out of them. Returns the rows from the first to the last in which some span must be limited.
WaveLoops::RowRange WaveStepper::balance()
{
  std::atomic<int> first{columns.ny}, last{0};
  const auto widen = [&](int row) {
    for (int known = first; row < known && !first.compare_exchange_weak(known, row);) {}
    for (int known = last; row + 1 > known && !last.compare_exchange_weak(known, row + 1);) {}
  };
  loops.rows([&](long from, long to) {
    for (long row = from; row < to; ++row)
      if (!run.kernels->balance(arrays, law, row, row + 1) && row <= columns.ny) widen(static_cast<int>(row) - 1);
  });
  loops.each_listed(columns.listed_spans, [&](long i) {    // including further spans, which lie in the rows after that
    const SpanFluxes<double> fluxes = fluxes_of(i);
    arrays.net[i] = fluxes.in - fluxes.out;
    if (fluxes.out_share(static_cast<double>(content[i])) != 1.0 ||
        fluxes.in_share(static_cast<double>(content[i]), most_in(i)) != 1.0)
      widen(columns.row_of(i));
  });
  return {first, last};
}

// A flux scaled down in one row changes the rows beside it, so each time one row more is affected.
void WaveStepper::limit(const WaveLoops::RowRange &tight)
{
  constexpr int SCALED = 3;    // repetitions
  ++run.counts.limited;
  const WaveLoops::RowRange near = {std::max(0, tight.first - SCALED), std::min(columns.ny, tight.last + SCALED)};
  double *share = arrays.net;    // of a span, for the leaving or for the entering flux
  const auto scale = [&](bool by_giver) {
    loops.each_link_in(near, [&](const LinkPlace &link) {
      const WaveLinks &l = columns.arrays_of(link);
      const Ends e = columns.ends(link);
      double &units = l.units[link.at];
      if (units == 0.0) return;
      const double part = share[(units > 0.0) == by_giver ? e.a : e.b];
      units = scaled_down(units, part);
      if (!by_giver) l.u[link.at] *= part;
    });
  };
  loops.each_span_in(near, [&](long i) { share[i] = fluxes_of(i).out_share(static_cast<double>(content[i])); });
  scale(true);
  for (int pass = 0; pass < 2; ++pass) {    // units that a span gives less in the first pass are missing as room in the second
    std::atomic<bool> fits{true};
    loops.each_span_in(near, [&](long i) {
      share[i] = fluxes_of(i).in_share(static_cast<double>(content[i]), most_in(i));
      if (share[i] != 1.0) fits.store(false, std::memory_order_relaxed);
    });
    if (fits) return;
    scale(false);
  }
}

}    // namespace mdanim
