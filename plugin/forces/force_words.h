// SPDX-License-Identifier: GPL-2.0-only
// Forces as users write them. All functions throw std::runtime_error where something is wrong.

#pragma once

#include "forces/law.h"

#include <map>
#include <string>

namespace mdanim {

// Words `force fx fy fz [from T] [to T]` and `torque tx ty tz [from T] [to T]`; `where` begins messages.
ForceWindows read_force(const std::string &text, const std::string &where);

// A file with lines of a molecule ID and these words, by molecule IDs.
std::map<int, ForceWindows> read_forces(const std::string &name, const std::string &text);

}    // namespace mdanim
