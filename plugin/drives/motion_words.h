// SPDX-License-Identifier: GPL-2.0-only
// Motions from words: of a command, or of a file with a line for each object.

#pragma once

#include "drives/law.h"

#include <map>
#include <string>

namespace mdanim {

// The words of a motion, up to the end. `where` begins messages. Throws std::runtime_error.
//   velocity vx vy vz | turn wx wy wz px py pz | oscillation dx dy dz frequency phase | pivot x y z | key T dx dy dz rx ry rz
DrivenMotion read_motion(const std::string &words, const std::string &where);

// By molecule IDs. Throws std::runtime_error with the line: `name` names the file.
std::map<int, DrivenMotion> read_motions(const std::string &name, const std::string &text);

}    // namespace mdanim
