// SPDX-License-Identifier: GPL-2.0-only
// What the states of liquids begin with, and what all of them are asked for.

#ifndef MDANIM_STATE_KIND_H
#define MDANIM_STATE_KIND_H

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

namespace mdanim {

// The kind of liquid and the version of its state: a word of up to seven letters and a number, which each kind counts for itself.
struct StateKind {
  char word[8];
  double version;

  // Throws std::runtime_error where `found` is another kind or version.
  void expect(const StateKind &found, const std::string &whose) const
  {
    if (std::memcmp(found.word, word, sizeof word) == 0 && found.version == version) return;
    throw std::runtime_error(whose + "is not of version " + std::to_string(static_cast<int>(version)) + " of kind " + word +
                             ", as this liquid's is; it was written for another model or by another version of the plugin");
  }
};

// Throws std::runtime_error where one of these numbers, named by what they are, is infinite or NaN, or below `least`.
template <class Numbers>
void need_numbers(const Numbers &numbers, const std::string &whose, const char *what, double least = -HUGE_VAL)
{
  for (const double number : numbers)
    if (!(std::isfinite(number) && number >= least))
      throw std::runtime_error(whose + "is damaged: " + what + " is " + std::to_string(number));
}

}    // namespace mdanim

#endif
