// SPDX-License-Identifier: GPL-2.0-only

#include "tearing/tear_rules.h"

#include "records/line_words.h"

#include <algorithm>
#include <tuple>

namespace mdanim {

namespace {

template <class Row> const Row *find_row(const std::vector<Row> &rows, int low, int high)
{
  const auto found = std::lower_bound(rows.begin(), rows.end(), std::make_pair(low, high), [](const Row &one, const auto &ends) {
    return std::tie(one.low, one.high) < std::tie(ends.first, ends.second);
  });
  return found != rows.end() && found->low == low && found->high == high ? &*found : nullptr;
}

template <class Row> void append(std::vector<Row> &rows, const Row &one, LineWords &words)
{
  if (!rows.empty() && std::tie(one.low, one.high) <= std::tie(rows.back().low, rows.back().high))
    words.fail("springs ascend by their lower and their higher end");
  rows.push_back(one);
}

int read_particle(LineWords &words)
{
  const int particle = words.number<int>("a particle of the object, from 1");
  if (particle < 1) words.fail("particles of an object count from 1, got " + std::to_string(particle));
  return particle - 1;
}

void read_link(LineWords &words, TearRules &rules)
{
  const int low = read_particle(words), high = read_particle(words);
  if (low >= high) words.fail("the lower end of a spring comes first");
  const double length = words.positive("the length of a link without load");
  append(rules.links, {low, high, length, words.positive("the length from which on it is gone")}, words);
}

void read_over(LineWords &words, TearRules &rules)
{
  const int low = read_particle(words), middle = read_particle(words), high = read_particle(words);
  if (low >= high) words.fail("the lower end of a spring comes first");
  TearOver one{low, middle, high, {words.positive("K"), words.at_least_zero("r0"), 0.0}, {}, {}, 0.0};
  for (int k = 0; k < 2; ++k) {
    const int end = k == 0 ? low : high;
    const TearLink *const link = rules.link(std::min(end, middle), std::max(end, middle));
    if (!link) words.fail("a spring lies over two links, whose lines come before it");
    one.length[k] = link->length, one.limit[k] = link->limit;
  }
  one.own = words.is_at_end() ? one.length[0] + one.length[1] : words.positive("the length of a spring without load");
  append(rules.overs, one, words);
}

}    // namespace

const TearLink *TearRules::link(int low, int high) const { return find_row(links, low, high); }

const TearOver *TearRules::over(int low, int high) const { return find_row(overs, low, high); }

std::map<int, TearRules> read_tear_rules(const std::string &name, const std::string &text)
{
  std::map<int, TearRules> found;
  TearRules *now = nullptr;
  each_line(name, text, [&](LineWords &words) {
    const std::string kind = words.word("object");
    if (kind == "object") {
      const int molecule = words.number<int>("a molecule ID");
      if (molecule < 1) words.fail(std::to_string(molecule) + " is not a molecule ID");
      if (found.count(molecule)) words.fail("object " + std::to_string(molecule) + " is there already");
      now = &found[molecule];
      now->strain = words.positive("the strain that springs bear");
      now->leaves_rest = !words.takes("whole");
    } else if (kind != "link" && kind != "over") {
      words.fail("a line begins with object, link or over, got " + kind);
    } else if (!now) {
      words.fail(kind + " belongs behind a line object MOLECULE STRAIN");
    } else {
      kind == "link" ? read_link(words, *now) : read_over(words, *now);
    }
    words.expect_end();
  });
  return found;
}

}    // namespace mdanim
