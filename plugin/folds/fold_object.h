// SPDX-License-Identifier: GPL-2.0-only
// Objects whose surfaces are kept apart: particles, and segments or triangles between them; and which pairs of them touch.

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

  std::size_t bytes() const
  {
    return particles.capacity() * sizeof(int) + rest.capacity() * sizeof(Vec3) + triangles.capacity() * sizeof(triangles[0]) +
           segments.capacity() * sizeof(segments[0]);
  }
};

struct FoldPair {
  int first, second;    // molecule IDs; equal ones touch themselves
  FoldLaw law;
  double apart = 0.0;    // of an object with itself: what is nearer than this without load does not touch
};

struct FoldTable {
  std::map<int, FoldObject> objects;    // by molecule ID
  std::vector<FoldPair> pairs;
};

// The table in a text. Throws std::runtime_error with the line: `name` names the file (docs/fix_mdanim_folds.md).
FoldTable read_folds(const std::string &name, const std::string &text);

}    // namespace mdanim
