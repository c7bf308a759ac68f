// SPDX-License-Identifier: GPL-2.0-only
// The file of shapes of rigid bodies: a line for each object.

#pragma once

#include "rigid/shape.h"
#include "rigid/solid.h"

#include <map>
#include <optional>
#include <string>

namespace mdanim {

struct GivenShape {
  Material material;
  bool held;
  bool driven;         // of one that is held: something moves it
  Pose pose;           // in space, when bodies are made; of one that is driven, at time 0 of its drive
  SolidShape shape;    // in its own frame
};

// Axes of a shape, if it is one of these, when bodies are made.
inline std::optional<Quaternion> axes_of(const std::map<int, GivenShape> &shapes, int id)
{
  const auto found = shapes.find(id);
  return found == shapes.end() ? std::nullopt : std::optional(found->second.pose.q);
}

// By molecule IDs. Throws std::runtime_error with the line: `name` names the file.
std::map<int, GivenShape> read_shapes(const std::string &name, const std::string &text);

}    // namespace mdanim
