// SPDX-License-Identifier: GPL-2.0-only
// bond_style mdanim/harmonic in plain steps: forces, energies and virials of rows. A thread computes whole chunks of rows. Where
// springs are only in the rows of their lower ends, it first computes the rows before its own once more, for the forces that its
// particles receive from them.

#include "lammps/bond_mdanim_harmonic.h"

#include "numbers/stopwatch.h"

#include "atom.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace mdanim;

// Rows are computed in stretches that stay in the first-level cache.
static constexpr int STRETCH = 512;
// Rows whose energies are summed in one chain: the sum depends on no thread.
static constexpr int CHUNK = 1024;
static constexpr double NS_OF_CHUNK = 40.0 * CHUNK;

// The springs of rows [begin, end), `n` in all.
void BondMdanimHarmonic::take_apart(int begin, int end, int n, Stretch &stretch) const
{
  const double *x = atom->x[0];
  const size_t room = n;
  if (n == 0) return;
  if (stretch.x.size() < room)
    for (auto *array : {&stretch.x, &stretch.y, &stretch.z, &stretch.push, &stretch.pull}) array->resize(room);
  for (int i = begin, at = 0; i < end; ++i) {
    const Vec3 here = vec3(x + 3 * i);
    for (const SpringRows::Link &link : rows[i]) {
      const Vec3 d = here - vec3(x + 3 * (i + link.offset));
      stretch.x[at] = d.x;
      stretch.y[at] = d.y;
      stretch.z[at] = d.z;
      const SpringCoeffs &own = law[link.type];
      stretch.push[at] = own.push;
      stretch.pull[at] = own.pull;
      ++at;
    }
  }
}

// The energies of the springs in `stretch`, added to `sum`; half of a bond's share goes to either end.
void BondMdanimHarmonic::energies(int begin, int end, int n, Stretch &stretch, double &sum) const
{
  stretch.K.resize(stretch.x.size());
  stretch.r0.resize(stretch.x.size());
  for (int i = begin, at = 0; i < end; ++i)
    for (const SpringRows::Link &link : rows[i]) {
      stretch.K[at] = spring[link.type].K;
      stretch.r0[at++] = spring[link.type].r0;
    }
  kernels.springs.energies(n, stretch.x.data(), stretch.y.data(), stretch.z.data(), stretch.r0.data(), stretch.K.data());
  const double share = upper_only ? 1.0 : 0.5;
  for (int at = 0; at < n; ++at) sum += share * stretch.K[at];
}

// Adds the dashpots of rows [begin, end) to `stretch`, and their forces on each particle to `on`.
void BondMdanimHarmonic::dashpots(int begin, int end, Stretch &stretch, std::vector<Vec3> &on) const
{
  for (int i = begin, at = 0; i < end; ++i)
    for (const SpringRows::Link &link : rows[i]) {
      const int own = at++, j = i + link.offset;
      const double c = law[link.type].c;
      if (c == 0.0) continue;
      const Vec3 d = vec3(atom->x[i]) - vec3(atom->x[j]), v = vec3(atom->v[i]) - vec3(atom->v[j]);
      const Vec3 push = dashpot_factor(c, d, v, floored_square(d)) * d;
      stretch.x[own] += push.x;
      stretch.y[own] += push.y;
      stretch.z[own] += push.z;
      on[i] += push;
      if (upper_only) on[j] -= push;
    }
}

void BondMdanimHarmonic::sum_rows(int begin, int end, const Stretch &stretch) const
{
  double *const *f = atom->f;
  for (int i = begin, at = 0; i < end; ++i) {
    Vec3 lower, upper;
    const int middle = at + rows.lower(i), end = at + rows[i].size();
    for (; at < middle; ++at) lower += {stretch.x[at], stretch.y[at], stretch.z[at]};
    for (; at < end; ++at) upper += {stretch.x[at], stretch.y[at], stretch.z[at]};
    add_to(f[i], lower + upper);
  }
}

BondMdanimHarmonic::Ring::Ring(int farthest)
{
  int places = 1;
  while (places <= farthest) places *= 2;
  force.resize(places);
  mask = places - 1;
}

// Half the work, the same bits: F_j = -F_i exactly and a - F = a + (-F), and rows come in ascending order, so that a particle has
// received the forces from its lower partners' rows by the time of its own row. Particles below `first` only pass forces on.
void BondMdanimHarmonic::sum_halves(int begin, int end, int first, const Stretch &stretch, Ring &received) const
{
  double *const *f = atom->f;
  for (int i = begin, at = 0; i < end; ++i) {
    Vec3 upper;
    for (const SpringRows::Link &link : rows[i]) {
      const Vec3 force{stretch.x[at], stretch.y[at], stretch.z[at]};
      upper += force;
      received.of(i + link.offset) -= force;
      ++at;
    }
    if (i >= first) add_to(f[i], received.of(i) + upper);
    received.of(i) = Vec3();
  }
}

// Computes the springs of rows [begin, end), of which particles from `first` on get their forces; returns their energy.
double BondMdanimHarmonic::compute_rows(int begin, int end, int first, std::vector<Vec3> *on, Workspace &with) const
{
  double sum = 0.0;
  for (int from = begin, to; from < end; from = to) {
    int springs = 0;
    for (to = from; to < end; ++to) {
      const int more = rows[to].size();
      if (to > from && springs + more > STRETCH) break;
      springs += more;
    }
    Stretch &stretch = with.stretch;
    take_apart(from, to, springs, stretch);
    if (eflag_global && from >= first) energies(from, to, springs, stretch, sum);
    kernels.springs.forces(springs, stretch.push.data(), stretch.pull.data(), stretch.x.data(), stretch.y.data(),
                           stretch.z.data());
    if (on) dashpots(from, to, stretch, *on);
    if (upper_only)
      sum_halves(from, to, first, stretch, with.received);
    else
      sum_rows(from, to, stretch);
  }
  return sum;
}

void BondMdanimHarmonic::compute(int eflag, int vflag)
{
  const Lap lap(seconds);
  ev_init(eflag, vflag);
  const bool other_lists = neighbor->ago == 0 || made_after != neighbor->ncalls;    // made in this step, or between two passes
  made_after = neighbor->ncalls;
  const bool remade = other_lists && source_changed();
  if (remade) make_rows();
  refresh_coefficients();

  const int nlocal = atom->nlocal, chunks = (nlocal + CHUNK - 1) / CHUNK;
  std::vector<Vec3> *on = nullptr;
  if (damped) {
    if (other_lists) loss.look(atom->tag, nlocal);
    on = &loss.forces(nlocal);
  }
  energy_of_chunk.resize(chunks);
  const auto compute_chunks = [&](long begin, long end) {
    Workspace with(upper_only ? farthest : 0);
    const int first = static_cast<int>(begin) * CHUNK;
    if (upper_only) compute_rows(std::max(first - farthest, 0), first, first, nullptr, with);
    for (long k = begin; k < end; ++k) {
      const int row = static_cast<int>(k) * CHUNK;
      energy_of_chunk[k] = compute_rows(row, std::min(row + CHUNK, nlocal), first, on, with);
    }
  };
  if (on)
    compute_chunks(0, chunks);    // a dashpot pushes both its particles
  else
    threads.parts(chunks, NS_OF_CHUNK, compute_chunks);
  for (const double one : energy_of_chunk) energy += one;
  if (on) loss.step(atom->v, update->dt, update->setupflag);
  if (eflag_atom || vflag_either) tally();
}

template <class Visit> void BondMdanimHarmonic::each_spring(Visit visit) const
{
  const double *x = atom->x[0];
  for (int i = 0; i < atom->nlocal; ++i) {
    const Vec3 here = vec3(x + 3 * i);
    for (const SpringRows::Link &link : rows[i]) visit(i, i + link.offset, link.type, here - vec3(x + 3 * (i + link.offset)));
  }
}

// Virial and energy of each particle in steps that need them. Half of a bond's share goes to either end, which tallies it in its
// own row where rows are whole.
void BondMdanimHarmonic::tally()
{
  const double share = upper_only ? 1.0 : 0.5;
  double sums[6] = {};
  each_spring([&](int i, int j, int type, const Vec3 &d) {
    const double r2 = dot(d, d);
    if (eflag_atom) {
      const double e = mdanim::energy(spring[type], std::sqrt(r2));
      eatom[i] += 0.5 * e;
      if (upper_only) eatom[j] += 0.5 * e;
    }
    if (!vflag_either) return;
    const SpringCoeffs &own = law[type];
    const double square = floored_square(d);
    double factor = spring_factor(own.push, own.pull, square);
    if (own.c > 0.0) factor += dashpot_factor(own.c, d, vec3(atom->v[i]) - vec3(atom->v[j]), square);
    const double w[6] = {d.x * d.x * factor, d.y * d.y * factor, d.z * d.z * factor,
                         d.x * d.y * factor, d.x * d.z * factor, d.y * d.z * factor};
    for (int k = 0; k < 6; ++k) sums[k] += share * w[k];
    if (!vflag_atom) return;
    for (int k = 0; k < 6; ++k) {
      vatom[i][k] += 0.5 * w[k];
      if (upper_only) vatom[j][k] += 0.5 * w[k];
    }
  });
  if (vflag_global) std::copy(sums, sums + 6, virial);
}
