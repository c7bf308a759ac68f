// SPDX-License-Identifier: GPL-2.0-only
// Contact bodies as a table of text (docs/fix_mdanim_contact.md).

#pragma once

#include "contact/contact_body.h"

#include <map>
#include <string>
#include <string_view>

namespace mdanim {

// All bodies of a text, by their numbers. Throws std::runtime_error with `name`, the line and the fault there.
std::map<int, ContactBody> read_bodies(const std::string &name, std::string_view text);

}    // namespace mdanim
