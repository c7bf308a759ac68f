// SPDX-License-Identifier: GPL-2.0-only
// A thread computes whole chunks of rows. Where springs are only in the rows of their lower ends, it first computes the rows
// before its own once more, for the forces that its particles receive from them.

#include "springs/row_forces.h"

#include <algorithm>
#include <cstddef>

namespace mdanim {

namespace {

// Rows are computed in stretches that stay in the first-level cache.
constexpr int STRETCH = 512;
// Rows whose energies are summed in one chain: the sum depends on no thread.
constexpr int CHUNK = 1024;
constexpr double NS_OF_CHUNK = 40.0 * CHUNK;

// The bonds of a few rows, one array per quantity, for the vector units.
struct Stretch {
  std::vector<double> x, y, z;       // r_ij, then F_i
  std::vector<double> push, pull;    // see SpringCoeffs
  std::vector<double> brake;         // of dashpots: c times the strain rate
  std::vector<double> K, r0;         // of energies, see Spring
};

// Forces that particles have received from lower partners so far, for sum_halves(): those from the present row to its farthest
// partner, in a ring of 2^n places.
class Ring {
 public:
  explicit Ring(int farthest)
  {
    int places = 1;
    while (places <= farthest) places *= 2;
    force.resize(places);
    mask = places - 1;
  }
  Vec3 &of(int i) { return force[i & mask]; }

 private:
  std::vector<Vec3> force;
  int mask;    // 2^n - 1
};

// Memory that a thread needs besides the rows.
struct Workspace {
  Stretch stretch;
  Ring received;
};

class RowLoops : RowSprings, RowParticles {
 public:
  RowLoops(const RowSprings &springs, const RowParticles &particles, const SpringKernels &kernels)
      : RowSprings(springs), RowParticles(particles), kernels(kernels)
  {
  }
  double compute(int begin, int end, int first, bool with_energy, std::vector<Vec3> *on, Workspace &with) const;

 private:
  void take_apart(int begin, int end, int n, Stretch &stretch) const;
  double energies(int begin, int end, int n, Stretch &stretch, double sum) const;
  void brake(int begin, int end, Stretch &stretch, std::vector<Vec3> &on) const;
  void sum_rows(int begin, int end, const Stretch &stretch) const;
  void sum_halves(int begin, int end, int first, const Stretch &stretch, Ring &received) const;

  const SpringKernels &kernels;
};

// The springs of rows [begin, end), `n` in all.
void RowLoops::take_apart(int begin, int end, int n, Stretch &stretch) const
{
  const std::size_t room = n;
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

// `sum` and the energies of the springs in `stretch`; half of a bond's share goes to either end.
double RowLoops::energies(int begin, int end, int n, Stretch &stretch, double sum) const
{
  stretch.K.resize(stretch.x.size());
  stretch.r0.resize(stretch.x.size());
  for (int i = begin, at = 0; i < end; ++i)
    for (const SpringRows::Link &link : rows[i]) {
      stretch.K[at] = spring[link.type].K;
      stretch.r0[at++] = spring[link.type].r0;
    }
  kernels.energies(n, stretch.x.data(), stretch.y.data(), stretch.z.data(), stretch.r0.data(), stretch.K.data());
  const double share = upper_only ? 1.0 : 0.5;
  for (int at = 0; at < n; ++at) sum += share * stretch.K[at];
  return sum;
}

// Puts the dashpots of rows [begin, end) beside their springs in `stretch`, and adds their forces on each particle to `on`.
void RowLoops::brake(int begin, int end, Stretch &stretch, std::vector<Vec3> &on) const
{
  stretch.brake.resize(stretch.x.size());
  for (int i = begin, at = 0; i < end; ++i)
    for (const SpringRows::Link &link : rows[i]) {
      double &own = stretch.brake[at++] = 0.0;
      const int j = i + link.offset;
      const double c = law[link.type].c;
      if (c == 0.0) continue;
      const Vec3 d = vec3(x + 3 * i) - vec3(x + 3 * j), vij = vec3(v + 3 * i) - vec3(v + 3 * j);
      own = c * strain_rate(d, vij, floored_square(d));
      on[i] -= own * d;
      if (upper_only) on[j] += own * d;
    }
}

void RowLoops::sum_rows(int begin, int end, const Stretch &stretch) const
{
  for (int i = begin, at = 0; i < end; ++i) {
    Vec3 lower, upper;
    const int middle = at + rows.lower(i), end = at + rows[i].size();
    for (; at < middle; ++at) lower += {stretch.x[at], stretch.y[at], stretch.z[at]};
    for (; at < end; ++at) upper += {stretch.x[at], stretch.y[at], stretch.z[at]};
    add_to(f + 3 * i, lower + upper);
  }
}

// Half the work, the same bits: F_j = -F_i exactly and a - F = a + (-F), and rows come in ascending order, so that a particle has
// received the forces from its lower partners' rows by the time of its own row. Particles below `first` only pass forces on.
void RowLoops::sum_halves(int begin, int end, int first, const Stretch &stretch, Ring &received) const
{
  for (int i = begin, at = 0; i < end; ++i) {
    Vec3 upper;
    for (const SpringRows::Link &link : rows[i]) {
      const Vec3 force{stretch.x[at], stretch.y[at], stretch.z[at]};
      upper += force;
      received.of(i + link.offset) -= force;
      ++at;
    }
    if (i >= first) add_to(f + 3 * i, received.of(i) + upper);
    received.of(i) = Vec3();
  }
}

// Computes the springs of rows [begin, end), of which particles from `first` on get their forces; returns their energy.
double RowLoops::compute(int begin, int end, int first, bool with_energy, std::vector<Vec3> *on, Workspace &with) const
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
    if (with_energy && from >= first) sum = energies(from, to, springs, stretch, sum);
    const auto data = [](std::vector<double> &of) { return of.data(); };
    if (on) {
      brake(from, to, stretch, *on);
      kernels.damped_forces(springs, data(stretch.push), data(stretch.pull), data(stretch.brake), data(stretch.x),
                            data(stretch.y), data(stretch.z));
    } else {
      kernels.forces(springs, data(stretch.push), data(stretch.pull), data(stretch.x), data(stretch.y), data(stretch.z));
    }
    if (upper_only)
      sum_halves(from, to, first, stretch, with.received);
    else
      sum_rows(from, to, stretch);
  }
  return sum;
}

}    // namespace

double add_row_forces(const RowSprings &springs, const RowParticles &particles, bool with_energy, std::vector<Vec3> *dashpots,
                      const Threads &threads, const SpringKernels &kernels)
{
  const RowLoops loops(springs, particles, kernels);
  const int many = springs.rows.size(), chunks = (many + CHUNK - 1) / CHUNK;
  std::vector<double> energy_of_chunk(chunks);
  const auto compute_chunks = [&](long begin, long end) {
    Workspace with{{}, Ring(springs.upper_only ? springs.farthest : 0)};
    const int first = static_cast<int>(begin) * CHUNK;
    if (springs.upper_only) loops.compute(std::max(first - springs.farthest, 0), first, first, with_energy, nullptr, with);
    for (long k = begin; k < end; ++k) {
      const int row = static_cast<int>(k) * CHUNK;
      energy_of_chunk[k] = loops.compute(row, std::min(row + CHUNK, many), first, with_energy, dashpots, with);
    }
  };
  if (dashpots)
    compute_chunks(0, chunks);
  else
    threads.parts(chunks, NS_OF_CHUNK, compute_chunks);
  double energy = 0.0;
  for (const double one : energy_of_chunk) energy += one;
  return energy;
}

}    // namespace mdanim
