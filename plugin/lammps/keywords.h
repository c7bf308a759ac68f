// SPDX-License-Identifier: GPL-2.0-only
// Words of a command. The message for one that ends too early says how it is written and what is missing.

#pragma once

#include "lmptype.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {
class LAMMPS;
}

namespace mdanim {

struct Keyword {
  std::string word;
  std::string values;       // as on the page of the style, with a space between two
  std::string instead{};    // for a keyword of former versions: the way out
};

// Refuses a command with only `got` words after `head`; words of `values` in brackets are optional.
void need_words(LAMMPS_NS::LAMMPS *lmp, const std::string &style, const std::string &head, const std::string &values, int got);

// Number of words of the keyword at `iarg` with its values. Refuses a keyword that is unknown or no longer exists, and missing
// values.
int words_of_keyword(LAMMPS_NS::LAMMPS *lmp, const std::string &style, const std::vector<Keyword> &known, int iarg, int narg,
                     char **arg);

}    // namespace mdanim
