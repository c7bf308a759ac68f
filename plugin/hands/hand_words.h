// SPDX-License-Identifier: GPL-2.0-only
// Hands as users write them. All functions throw std::runtime_error where something is wrong.

#pragma once

#include "hands/law.h"

#include <string>
#include <vector>

namespace mdanim {

// Words `stiffness k damping c most F particles n tag w tag w ... [key t x y z] ...`; `where` begins messages.
Hand read_hand(const std::string &text, const std::string &where);
// Words `t x y z` of a key behind the last one of a hand.
HandKey read_key(const std::string &text, const std::string &where, const Hand &of);
// A file with a line for each hand.
std::vector<Hand> read_hands(const std::string &name, const std::string &text);

}    // namespace mdanim
