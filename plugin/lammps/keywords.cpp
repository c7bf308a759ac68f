// SPDX-License-Identifier: GPL-2.0-only
#include "lammps/keywords.h"

#include "error.h"
#include "fmt/format.h"
#include "lammps.h"
#include "utils.h"

#include <algorithm>
#include <sstream>

using namespace LAMMPS_NS;

// "a", "a and b", "a, b and c".
static std::string listed(const std::vector<std::string> &words, const std::string &last = " and ")
{
  std::string text;
  for (std::size_t n = 0; n < words.size(); ++n) text += (n == 0 ? "" : n + 1 < words.size() ? ", " : last) + words[n];
  return text;
}

// Words of the form that must be given, in their order.
static std::vector<std::string> needed(const std::string &values)
{
  std::vector<std::string> words;
  std::istringstream stream(values);
  for (std::string word; stream >> word;)
    if (word[0] != '[') words.push_back(word);
  return words;
}

static void refuse_missing(LAMMPS *lmp, const std::string &style, const std::string &head, const std::string &values, int got,
                           int place)
{
  const std::vector<std::string> all = needed(values), missing(all.begin() + got, all.end());
  lmp->error->all(FLERR, place, "{}: missing arguments, it is written as '{} {}'; got {} of them, {} {} missing", style, head,
                  values, got, listed(missing), missing.size() == 1 ? "is" : "are");
}

void mdanim::need_words(LAMMPS *lmp, const std::string &style, const std::string &head, const std::string &values, int got)
{
  if (got < static_cast<int>(needed(values).size())) refuse_missing(lmp, style, head, values, got, Error::ARGZERO);
}

int mdanim::words_of_keyword(LAMMPS *lmp, const std::string &style, const std::vector<Keyword> &known, int iarg, int narg,
                             char **arg)
{
  const auto found = std::find_if(known.begin(), known.end(), [&](const Keyword &one) { return one.word == arg[iarg]; });
  if (found == known.end()) {
    std::vector<std::string> words;
    for (const Keyword &one : known)
      if (one.instead.empty()) words.push_back(one.word);
    lmp->error->all(FLERR, iarg, "{}: unknown keyword {}; it knows {}", style, arg[iarg], listed(words));
  }
  if (!found->instead.empty()) lmp->error->all(FLERR, iarg, "{}: {} is not there any more; {}", style, arg[iarg], found->instead);
  const int count = static_cast<int>(needed(found->values).size()), got = narg - iarg - 1;
  if (got < count) refuse_missing(lmp, style, found->word, found->values, got, iarg);
  return 1 + count;
}

int mdanim::take_keyword(LAMMPS *lmp, const std::string &style, const std::vector<Keyword> &known, int iarg, int narg, char **arg)
{
  const int words = words_of_keyword(lmp, style, known, iarg, narg, arg);
  for (const Keyword &one : known)
    if (one.word == arg[iarg]) one.take(iarg, arg);
  return words;
}

int mdanim::choice(LAMMPS *lmp, const std::string &style, const char *what, std::initializer_list<const char *> words, int at,
                   char **arg)
{
  const std::vector<std::string> all(words.begin(), words.end());
  const auto found = std::find(all.begin(), all.end(), arg[at]);
  if (found == all.end()) lmp->error->all(FLERR, at, "{}: {} {}, got {}", style, what, listed(all, " or "), arg[at]);
  return static_cast<int>(found - all.begin());
}

double mdanim::positive(LAMMPS *lmp, const std::string &style, const std::string &what, int at, char **arg)
{
  const double value = utils::numeric(FLERR, arg[at], false, lmp);
  if (!(value > 0.0)) lmp->error->all(FLERR, at, "{}: {} must be > 0, got {}", style, what, arg[at]);
  return value;
}

std::pair<int, int> mdanim::two_molecules(LAMMPS *lmp, const std::string &style, int at, char **arg)
{
  const int a = utils::inumeric(FLERR, arg[at], false, lmp), b = utils::inumeric(FLERR, arg[at + 1], false, lmp);
  if (a < 1 || b < 1 || a == b)
    lmp->error->all(FLERR, at, "{}: a pair is two different molecule IDs > 0, got {} and {}", style, arg[at], arg[at + 1]);
  return std::minmax(a, b);
}
