// SPDX-License-Identifier: GPL-2.0-only

#include "hands/hand_words.h"

#include "records/line_words.h"

#include <utility>

namespace mdanim {

static void expect(LineWords &words, const char *what)
{
  if (const std::string found = words.word(what); found != what) words.fail(std::string(what) + " is expected, got " + found);
}

static HandKey next_key(LineWords &words, const Hand &of)
{
  HandKey key{words.number<double>("the time of a key"), {}};
  key.at = words.vector("the place of a key");
  if (!of.keys.empty() && !(key.time > of.keys.back().time))
    words.fail("times of keys rise, got " + LineWords::short_form(key.time) + " after " +
               LineWords::short_form(of.keys.back().time));
  return key;
}

static Hand next_hand(LineWords &words)
{
  Hand found;
  expect(words, "stiffness");
  found.stiffness = words.at_least_zero("the stiffness");
  expect(words, "damping");
  found.damping = words.at_least_zero("the damping");
  expect(words, "most");
  found.most = words.positive("the largest force");
  expect(words, "particles");
  for (int n = words.many("the number of particles", 2); n > 0; --n) {
    const double tag = words.positive("a particle");
    found.tags.push_back(static_cast<std::int64_t>(tag));
    if (static_cast<double>(found.tags.back()) != tag) words.fail("a particle is told by its ID, a whole number");
    found.weights.push_back(words.number<double>("the weight of a particle"));
  }
  if (found.tags.empty()) words.fail("a hand holds on to one particle at least");
  while (!words.is_at_end()) {
    expect(words, "key");
    found.keys.push_back(next_key(words, found));
  }
  return found;
}

Hand read_hand(const std::string &text, const std::string &where)
{
  LineWords words(text, where);
  return next_hand(words);
}

HandKey read_key(const std::string &text, const std::string &where, const Hand &of)
{
  LineWords words(text, where);
  const HandKey key = next_key(words, of);
  words.expect_end();
  return key;
}

std::vector<Hand> read_hands(const std::string &name, const std::string &text)
{
  std::vector<Hand> found;
  each_line(name, text, [&](LineWords &words) { found.push_back(next_hand(words)); });
  return found;
}

}    // namespace mdanim
