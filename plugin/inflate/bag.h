// SPDX-License-Identifier: GPL-2.0-only
// The closed surface of an object with gas in it: triangles of its particles.

#pragma once

#include "inflate/law.h"
#include "numbers/vec3.h"

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace mdanim {

// Triangles that objects may share.
class BagSurface {
 public:
  using Corners = std::array<int, 3>;

  // Particles count from 0, the lowest tag of the object.
  void append(const Corners &corners) { triangles.push_back(corners); }
  // Numbers the particles that triangles need; to be called once, when all are there. Throws std::runtime_error where an edge has
  // not one triangle on either side.
  void finish();

  // Particles that it needs, ascending; these are its nodes.
  const std::vector<int> &nodes() const { return needed; }
  bool is_empty() const { return triangles.empty(); }
  std::size_t bytes() const { return triangles.capacity() * sizeof(Corners) + needed.capacity() * sizeof(int); }

  double volume(const std::vector<Vec3> &x) const;
  // The gradient of the volume, by nodes: an area each, with its direction.
  void find_areas(const std::vector<Vec3> &x, std::vector<Vec3> &areas) const;

 private:
  std::vector<Corners> triangles;    // of particles, after finish() of nodes
  std::vector<int> needed;
};

struct Bag {
  GasLaw gas;
  std::shared_ptr<const BagSurface> surface;
};

// Bags from a text, by molecule IDs. Throws std::runtime_error with the line: `name` names the file (docs/fix_mdanim_inflate.md).
std::map<int, Bag> read_bags(const std::string &name, const std::string &text);

}    // namespace mdanim
