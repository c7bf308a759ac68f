// SPDX-License-Identifier: GPL-2.0-only
// Words of a command. The message for one that ends too early says how it is written and what is missing.

#pragma once

#include "lmptype.h"

#include <functional>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {
class LAMMPS;
}

namespace mdanim {

struct Keyword {
  std::string word;
  std::string values;       // as on the page of the style, with a space between two
  std::string instead{};    // for a keyword of former versions: the way out
  // Takes the values; `at` is the place of the word among `arg`.
  std::function<void(int at, char **arg)> take{};
};

// Refuses a command with only `got` words after `head`; words of `values` in brackets are optional.
void need_words(LAMMPS_NS::LAMMPS *lmp, const std::string &style, const std::string &head, const std::string &values, int got);

// Number of words of the keyword at `iarg` with its values. Refuses a keyword that is unknown or no longer exists, and missing
// values.
int words_of_keyword(LAMMPS_NS::LAMMPS *lmp, const std::string &style, const std::vector<Keyword> &known, int iarg, int narg,
                     char **arg);
// Takes the keyword at `iarg` with its values, and returns the number of words.
int take_keyword(LAMMPS_NS::LAMMPS *lmp, const std::string &style, const std::vector<Keyword> &known, int iarg, int narg,
                 char **arg);

// Place in `words` of the word at `at`; refuses any other. `what` names it in the message.
int choice(LAMMPS_NS::LAMMPS *lmp, const std::string &style, const char *what, std::initializer_list<const char *> words, int at,
           char **arg);
// The number at `at`; refuses one that is not > 0.
double positive(LAMMPS_NS::LAMMPS *lmp, const std::string &style, const std::string &what, int at, char **arg);

// Two different molecule IDs, those at `at` and behind it, the lower one first; refuses all else.
std::pair<int, int> two_molecules(LAMMPS_NS::LAMMPS *lmp, const std::string &style, int at, char **arg);

}    // namespace mdanim
