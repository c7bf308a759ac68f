// SPDX-License-Identifier: GPL-2.0-only
// Objects whose surfaces are kept apart: particles, and segments or triangles between them, or cells, whose faces are cut into
// triangles; and which pairs of them touch.

#pragma once

#include "folds/law.h"
#include "numbers/vec3.h"

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace mdanim {

struct FoldObject {
  std::vector<int> particles;                   // numbers from the lowest tag of the object, ascending
  std::vector<Vec3> rest;                       // their places without load, in any frame
  std::vector<double> weight;                   // part of the stiffness of a pair that each has
  std::vector<std::array<int, 3>> triangles;    // entries of `particles`
  std::vector<std::array<int, 2>> segments;     // the same; an object has one of both
  std::vector<std::array<int, 8>> cells;        // the same: the corners of a hexahedron, in the order of VTK
  std::vector<std::array<int, 2>> sides;        // the cells on both sides of each triangle of these, -1 for none

  // Whether two corners of a cell are at the ends of a body diagonal.
  static bool is_across(int a, int b) { return (a < 4) != (b < 4) && (a % 4 + 2) % 4 == b % 4; }
  // Makes the triangles of all faces of the cells, two of each.
  void cut_faces();
  std::size_t bytes() const
  {
    return particles.capacity() * sizeof(int) + rest.capacity() * sizeof(Vec3) + triangles.capacity() * sizeof(triangles[0]) +
           segments.capacity() * sizeof(segments[0]) + cells.capacity() * sizeof(cells[0]) + sides.capacity() * sizeof(sides[0]);
  }
};

struct FoldPair {
  int first, second;    // molecule IDs; equal ones touch themselves
  FoldLaw law;
  double apart =
      0.0;    // of an object with itself: what is nearer than this without load does not touch; 0 where pieces alone do
};

// Whether objects may touch before anything is torn: parts of one that are apart without load, and two that have no cells. Links
// keep other parts of one near each other, and cells are touched where they are laid bare.
inline bool touch_untorn(const FoldObject &a, const FoldObject &b, double apart)
{ return apart > 0.0 || !(&a == &b || !a.cells.empty() || !b.cells.empty()); }

struct FoldTable {
  std::map<int, FoldObject> objects;    // by molecule ID
  std::vector<FoldPair> pairs;
};

// The table in a text. Throws std::runtime_error with the line: `name` names the file (docs/fix_mdanim_folds.md).
FoldTable read_folds(const std::string &name, const std::string &text);

}    // namespace mdanim
