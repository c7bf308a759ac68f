// SPDX-License-Identifier: GPL-2.0-only
// Rings of objects, as a text gives them.

#pragma once

#include "tearing/bend_law.h"

#include <map>
#include <string>
#include <vector>

namespace mdanim {

// Rings by molecule IDs. Throws std::runtime_error with the line: `name` names the file (docs/fix_mdanim_yield.md).
std::map<int, std::vector<BendRing>> read_bends(const std::string &name, const std::string &text);

}    // namespace mdanim
