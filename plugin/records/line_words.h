// SPDX-License-Identifier: GPL-2.0-only
// Files with a line for each object: its words, one after the other. All functions throw std::runtime_error with the line.

#pragma once

#include "numbers/vec3.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace mdanim {

class LineWords {
 public:
  LineWords(std::string line, std::string where) : line(std::move(line)), where(std::move(where)) {}

  [[noreturn]] void fail(const std::string &why) const { throw std::runtime_error(where + ": " + why); }
  std::string word(const char *what)
  {
    at = std::min(line.find_first_not_of(" \t\r", at), line.size());
    const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
    if (end == at) fail(std::string(what) + " is missing");
    std::string found = line.substr(at, end - at);
    at = end;
    return found;
  }
  // Goes on behind the next word, if it is this one.
  bool takes(const std::string &wanted)
  {
    const std::size_t before = at;
    if (!is_at_end() && word("a word") == wanted) return true;
    at = before;
    return false;
  }
  bool is_at_end() const { return line.find_first_not_of(" \t\r", at) == std::string::npos; }
  void expect_end()
  {
    if (!is_at_end()) fail("there is more than belongs to it, from " + word("more") + " on");
  }
  template <class Number> Number number(const char *what)
  {
    const std::string found = word(what);
    Number value{};
    const auto [end, error] = std::from_chars(found.data(), found.data() + found.size(), value);
    if (error != std::errc() || end != found.data() + found.size() || !std::isfinite(static_cast<double>(value)))
      fail(found + " is not a " + (std::numeric_limits<Number>::is_integer ? "whole " : "") + "number; it stands for " + what);
    return value;
  }
  double positive(const char *what)
  {
    const double value = number<double>(what);
    if (!(value > 0.0)) fail(std::string(what) + " must be above 0");
    return value;
  }
  double at_least_zero(const char *what)
  {
    const double value = number<double>(what);
    if (!(value >= 0.0)) fail(std::string(what) + " must be at least 0");
    return value;
  }
  double from_zero_to(const char *what, double most)
  {
    const double value = at_least_zero(what);
    if (value > most) fail(std::string(what) + " must be at most " + short_form(most) + ", got " + short_form(value));
    return value;
  }
  // A length of a shape: powers of it, as volumes and moments, stay numbers.
  double extent(const char *what)
  {
    const double value = positive(what);
    if (value < LEAST || value > MOST)
      fail(std::string(what) + " must be from " + short_form(LEAST) + " to " + short_form(MOST) + ", got " + short_form(value));
    return value;
  }
  int molecule()
  {
    const double value = number<double>("the molecule ID");
    const int id = value >= 1.0 && value < std::numeric_limits<int>::max() ? static_cast<int>(value) : 0;
    if (id != value || id < 1) {
      at = 0;
      fail(word("the molecule ID") + " is not a molecule ID");
    }
    return id;
  }
  Vec3 vector(const char *what)
  {
    const double x = number<double>(what), y = number<double>(what);
    return {x, y, number<double>(what)};
  }
  // A point of a shape.
  Vec3 place(const char *what)
  {
    const Vec3 at = vector(what);
    if (std::max({std::fabs(at.x), std::fabs(at.y), std::fabs(at.z)}) > MOST)
      fail(std::string(what) + " must be within " + short_form(MOST) + " of the origin");
    return at;
  }
  // Six digits of a number.
  static std::string short_form(double value)
  {
    std::ostringstream text;
    text << value;
    return text.str();
  }
  // The number of things of `size` words each that follow.
  int many(const char *what, std::size_t size)
  {
    const int count = number<int>(what);
    if (count < 0 || count > static_cast<int>((line.size() - at) / (2 * size)))
      fail(std::string(what) + " is more than the line has");
    return count;
  }

 private:
  static constexpr double LEAST = 1e-50, MOST = 1e50;
  std::string line, where;
  std::size_t at = 0;
};

// Calls visit(words) for each line that is not empty; # begins a comment. `name` names the file.
template <class Visit> void each_line(const std::string &name, const std::string &text, const Visit &visit)
{
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    line.erase(std::min(line.find('#'), line.size()));
    LineWords words(line, "line " + std::to_string(number) + " of " + name);
    if (!words.is_at_end()) visit(words);
  }
}

// A file with a line for each object, a molecule ID and what read(words) makes of the rest: by molecule IDs, none of which may
// stand twice.
template <class Read> auto by_molecule(const std::string &name, const std::string &text, const Read &read)
{
  std::map<int, decltype(read(std::declval<LineWords &>()))> found;
  each_line(name, text, [&](LineWords &words) {
    const int molecule = words.molecule();
    if (!found.emplace(molecule, read(words)).second) words.fail("object " + std::to_string(molecule) + " has a line already");
  });
  return found;
}

}    // namespace mdanim
