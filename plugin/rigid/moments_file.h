// SPDX-License-Identifier: GPL-2.0-only
// The file of moments of inertia: a line for each object, its molecule ID and Ixx Iyy Izz Ixy Ixz Iyz about its centre.

#pragma once

#include "rigid/inertia.h"

#include <map>
#include <string>

namespace mdanim {

// By molecule IDs. Throws std::runtime_error with the line: `name` names the file.
std::map<int, Inertia> read_moments(const std::string &name, const std::string &text);

}    // namespace mdanim
