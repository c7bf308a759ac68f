// SPDX-License-Identifier: GPL-2.0-only
// Spray: whole units that leave steep fronts and impacts, fly as points and come back. docs/physics-liquid.md, "Drops".

#pragma once

#include "liquid/waves/span.h"
#include "numbers/vec3.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mdanim {

class Waves;

// Units that fly are not in the waves: the sum of both never changes. Drops are in the order in which they left.
class Drops {
 public:
  struct Drop {
    Vec3 x, v;
    Units units;
  };

  Drops(int nx, int ny, std::uint64_t seed) : nx(nx), ny(ny), seed(seed) {}

  // To be called after an update of the waves of the same time. `when` counts updates; the same number gives the same drops.
  void update(Waves &waves, double dt, std::uint64_t when);

  const std::vector<Drop> &all() const { return drops; }
  Units total() const;
  double energy() const;    // as Waves::Energy
  Vec3 momentum() const;    // as Waves::momentum(), and upwards
  std::vector<std::uint8_t> state() const;
  // Throws std::runtime_error, and changes nothing, when the state is damaged.
  void set_state(const std::uint8_t *bytes, std::size_t size);

  double share = 0.0;         // part of the liquid that rises too fast that leaves: 0 none, 1 all
  std::size_t most = 2048;    // drops; beyond that, neighbours in the order are joined

 private:
  void leave(Waves &waves, double dt, std::uint64_t when);
  void fly(const SolidParts &solid, double dt);
  void land(Waves &waves, const std::vector<double> &from);
  void merge();

  int nx, ny;
  std::uint64_t seed;
  std::vector<Drop> drops;
};

}    // namespace mdanim
