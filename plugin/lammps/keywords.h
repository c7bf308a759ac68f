// SPDX-License-Identifier: GPL-2.0-only
// Words of a command: one that ends too early is told how it is written and what is missing.

#ifndef MDANIM_WORDS_H
#define MDANIM_WORDS_H

#include "lmptype.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {
class LAMMPS;
}

namespace mdanim {

struct Keyword {
  std::string word;
  std::string values;       // as the page of the style writes them, with a space between two
  std::string instead{};    // of one that there was: the way out
};

// Refuses a command of which only `got` words after `head` are there; words of `values` in brackets may be left out.
void need_words(LAMMPS_NS::LAMMPS *lmp, const std::string &style, const std::string &head, const std::string &values, int got);

// How many words the keyword at `iarg` takes with its values. Refuses one that is not known or not
// there any more, and values that are missing.
int words_of_keyword(LAMMPS_NS::LAMMPS *lmp, const std::string &style, const std::vector<Keyword> &known, int iarg, int narg,
                     char **arg);

}    // namespace mdanim

#endif
