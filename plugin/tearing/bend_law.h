// SPDX-License-Identifier: GPL-2.0-only
// Bends that stay in a layer of particles whose springs resist bending.
//
// A ring is a particle, its middle m, with those around it in turn, with the normal of their triangles:
//   N = sum of (x_a - x_m) x (x_b - x_m),   n = N sqrt(1 + BLUNT^2)/s,   s^2 = N^2 + (BLUNT A)^2,   A = N without load.
// Where a ring is folded flat N vanishes, and there n fades, so that forces and their changes stay limited.
//
// Across a ring go lines of three or four of its particles, with weights w_i that have the sum 0: k = n . sum of w_i x_i is the
// curvature along it, and the springs of the layer have the energy c k^2/2. A line that is bent by b for good has besides
//   U = -c b k + c b^2/2 + c b0^2/2,
// with b0 = k in the body without load; together c (k - b)^2/2 beyond what is there without load. Before the forces of each step
//   b = k -+ most   where   +-(k - b) > most:
// ideal plasticity in bending, with the moment c most. Places alone decide, and all who look at a ring find the same.

#pragma once

#include "numbers/vec3.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace mdanim {

constexpr double BLUNT = 0.3;

struct BendLine {
  static constexpr int MOST = 4;    // particles
  double stiffness, most, first;    // c [energy length], most and b0 [1/length]
  int count = 0;                    // of its particles
  int at[MOST] = {};                // among those of the ring
  double weight[MOST] = {};         // [1/length^2]
};

struct BendRing {
  std::vector<int> of;    // its particles, the middle one first; of the object, counted from its lowest tag, 0
  bool is_closed = false;
  double area = 0.0;    // A, twice that of its triangles
  int slot = 0;         // place of its first line among those of the middle particle
  std::vector<BendLine> lines;
};

// A ring with its particles at x.
class BendShape {
 public:
  BendShape(const BendRing &ring, const std::vector<Vec3> &x) : ring(ring), x(x)
  {
    Vec3 sum;
    each_side([&](int a, int b) { sum += cross(arm(a), arm(b)); });
    size = std::sqrt(dot(sum, sum) + BLUNT * ring.area * BLUNT * ring.area);
    along = (1.0 / size) * sum;
    normal = std::sqrt(1.0 + BLUNT * BLUNT) * along;
  }

  double curvature(const BendLine &line) const { return dot(normal, bend(line)); }

  // Adds the forces of lines that are bent by `bent`, times `factor`, to those of the particles of the ring.
  void push(const double *bent, double factor, std::vector<Vec3> &force) const
  {
    Vec3 all;
    for (std::size_t l = 0; l < ring.lines.size(); ++l) {
      const BendLine &line = ring.lines[l];
      const double moment = factor * line.stiffness * bent[l];
      for (int k = 0; k < line.count; ++k) force[line.at[k]] += (moment * line.weight[k]) * normal;
      all += moment * bend(line);
    }
    const Vec3 turn = (std::sqrt(1.0 + BLUNT * BLUNT) / size) * (all - dot(along, all) * along);
    each_side([&](int a, int b) {
      const Vec3 one = cross(arm(b), turn), other = cross(turn, arm(a));
      force[a] += one;
      force[b] += other;
      force[0] -= one + other;
    });
  }

  double energy(const double *bent) const
  {
    double found = 0.0;
    for (std::size_t l = 0; l < ring.lines.size(); ++l) {
      const BendLine &line = ring.lines[l];
      found += line.stiffness * (0.5 * (bent[l] * bent[l] + line.first * line.first) - bent[l] * curvature(line));
    }
    return found;
  }

 private:
  Vec3 arm(int a) const { return x[a] - x[0]; }
  Vec3 bend(const BendLine &line) const
  {
    Vec3 found;
    for (int k = 0; k < line.count; ++k) found += line.weight[k] * arm(line.at[k]);
    return found;
  }
  template <class Visit> void each_side(const Visit &visit) const
  {
    const int last = static_cast<int>(ring.of.size()) - 1;
    for (int a = 1; a < last; ++a) visit(a, a + 1);
    if (ring.is_closed) visit(last, 1);
  }

  const BendRing &ring;
  const std::vector<Vec3> &x;
  Vec3 normal, along;
  double size;
};

// The bend of a line that was bent by `before`, at a curvature.
inline double bent(double curvature, double before, double most)
{ return std::abs(curvature - before) <= most ? before : curvature - std::copysign(most, curvature - before); }

}    // namespace mdanim
